//! One answer that is garbled on its way does not end a run, whatever the link: the connection is made again, the step
//! resumed, and the digest that of an undisturbed run. A PLC that never says anything else does.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::plc::Plc;
use crate::typed::{digests, run_shear, scenario, typed};

/// Lets connections to `server` through, except the answers with the numbers that `is_garbled` names: their first
/// bytes are others. Gives its own address.
fn garbling(server: &str, is_garbled: fn(usize) -> bool) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let (server, count) = (server.to_owned(), Arc::new(AtomicUsize::new(0)));
    std::thread::spawn(move || {
        while let Ok((client, _)) = listener.accept() {
            let Ok(behind) = TcpStream::connect(&server) else { return };
            let (to, from) = (client.try_clone().unwrap(), behind.try_clone().unwrap());
            std::thread::spawn(move || carry(&client, &behind, |_| ()));
            let count = Arc::clone(&count);
            std::thread::spawn(move || {
                carry(&from, &to, |answer| {
                    if is_garbled(count.fetch_add(1, Ordering::SeqCst)) {
                        answer.iter_mut().take(4).for_each(|byte| *byte = 0xff);
                    }
                });
            });
        }
    });
    address
}

fn carry(mut from: &TcpStream, mut to: &TcpStream, change: impl Fn(&mut [u8])) {
    let mut buffer = vec![0; 64 * 1024];
    while let Ok(count @ 1..) = from.read(&mut buffer) {
        change(&mut buffer[..count]);
        if to.write_all(&buffer[..count]).is_err() {
            break;
        }
    }
    // Either may be gone already.
    let _ = from.shutdown(Shutdown::Both);
    let _ = to.shutdown(Shutdown::Both);
}

/// The `--gateway` for what garbles before the PLC's link.
fn before(plc: &Plc, scheme: &str, is_garbled: fn(usize) -> bool) -> String {
    let url = plc.gateway(scheme);
    let (head, server) = url.split_once("://").expect("a URL");
    let server = server.trim_end_matches('/');
    format!("{head}://{}", garbling(server, is_garbled))
}

#[test]
fn one_garbled_answer_is_survived_over_every_link() {
    let (reports, _) = run_shear(&["--until", "1s"]);
    let plc = Plc::start(&scenario("shear"), &[]);
    for scheme in ["modbus://", "ads://"] {
        let gateway = before(&plc, scheme, |answer| answer == 120);
        let said = typed(&scenario("shear"), &["run", ".", "--format", "json", "--until", "1s", "--gateway", &gateway]);
        assert_eq!(said.code, Some(0), "{scheme}: {said:?}");
        let report = serde_json::from_str(&said.out).expect("a report");
        assert_eq!(digests(&[report]), digests(&reports), "{scheme}");
        assert!(said.err.contains("connecting again"), "{scheme}: {said:?}");
    }
}

#[test]
fn a_plc_that_says_nothing_else_ends_the_run() {
    let plc = Plc::start(&scenario("shear"), &[]);
    for scheme in ["modbus://", "ads://"] {
        let gateway = before(&plc, scheme, |answer| answer >= 120);
        let said = typed(&scenario("shear"), &["run", ".", "--until", "1s", "--gateway", &gateway]);
        assert_eq!(said.code, Some(3), "{scheme}: {said:?}");
        assert!(said.out.contains("the PLC sent what cannot be understood"), "{scheme}: {said:?}");
    }
}
