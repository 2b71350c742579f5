//! The S7 link: blocks over ISO-on-TCP, whatever comes of them on the way.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::time::Duration;

use crate::plc::Plc;
use crate::typed::{copied_shear, digests, edit, run_shear, scenario, typed};

/// What a proxy does with the answers of a server.
type Treat = fn(answer: usize, bytes: &[u8], client: &mut TcpStream) -> std::io::Result<()>;

/// A proxy to `server` that hands over what it says by `treat`; its address.
fn proxy(server: String, treat: Treat) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for client in listener.incoming() {
            // Who is gone again needs no server.
            let (Ok(client), Ok(server)) = (client, TcpStream::connect(&server)) else { continue };
            client.set_nodelay(true).unwrap();
            server.set_nodelay(true).unwrap();
            let (mut asking, mut asked) = (client.try_clone().unwrap(), server.try_clone().unwrap());
            std::thread::spawn(move || {
                // Either may be gone already.
                let _ = std::io::copy(&mut asking, &mut asked);
                let _ = asked.shutdown(Shutdown::Both);
            });
            std::thread::spawn(move || {
                // Either may be gone already.
                let _ = answers(server, &client, treat);
                let _ = client.shutdown(Shutdown::Both);
            });
        }
    });
    address.to_string()
}

/// Every telegram of the server goes through `treat`.
fn answers(mut server: TcpStream, client: &TcpStream, treat: Treat) -> std::io::Result<()> {
    let mut client = client.try_clone()?;
    for answer in 0.. {
        let mut head = [0; 4];
        server.read_exact(&mut head)?;
        let mut bytes = vec![0; usize::from(u16::from_be_bytes([head[2], head[3]]))];
        bytes[..4].copy_from_slice(&head);
        server.read_exact(&mut bytes[4..])?;
        treat(answer, &bytes, &mut client)?;
    }
    client.flush()
}

/// Each answer is cut one byte later than the one before, so that in time it is cut everywhere. A segment is on its way
/// alone for a while; how long does not matter.
fn cut(answer: usize, bytes: &[u8], client: &mut TcpStream) -> std::io::Result<()> {
    let (front, rest) = bytes.split_at(answer % bytes.len());
    client.write_all(front)?;
    std::thread::park_timeout(Duration::from_micros(500));
    client.write_all(rest)
}

/// The connection is reset within an answer, now and then.
fn broken(answer: usize, bytes: &[u8], client: &mut TcpStream) -> std::io::Result<()> {
    if answer == 40 {
        client.write_all(&bytes[..bytes.len() / 2])?;
        return Err(std::io::ErrorKind::ConnectionReset.into());
    }
    client.write_all(bytes)
}

/// Nothing is said any more over this connection.
fn silent(answer: usize, bytes: &[u8], client: &mut TcpStream) -> std::io::Result<()> {
    if answer < 40 { client.write_all(bytes) } else { Ok(()) }
}

fn over(treat: Treat, until: &str) -> (Vec<serde_json::Value>, crate::typed::Said) {
    let plc = Plc::start(&scenario("shear"), &["--cycle", "max", "--s7", "127.0.0.1:0"]);
    let server = plc.gateway("s7://").replace("plc=s7://", "");
    let gateway = format!("plc=s7://{}", proxy(server, treat));
    run_shear(&["--until", until, "--gateway", &gateway])
}

#[test]
fn an_answer_may_be_cut_at_every_byte() {
    let (expected, _) = run_shear(&["--until", "2s"]);
    let (reports, said) = over(cut, "2s");
    assert_eq!(digests(&reports), digests(&expected), "{said:?}");
    assert!(!said.err.contains("connection lost"), "{said:?}");
}

#[test]
fn a_connection_that_breaks_within_an_answer_is_made_again() {
    let (expected, _) = run_shear(&["--until", "2s"]);
    let (reports, said) = over(broken, "2s");
    assert_eq!(digests(&reports), digests(&expected), "{said:?}");
    assert!(said.err.contains("connection lost: closed by the PLC, during grant"), "{said:?}");
}

#[test]
fn a_plc_that_falls_silent_is_named_so() {
    let (expected, _) = run_shear(&["--until", "200ms"]);
    let (reports, said) = over(silent, "200ms");
    assert_eq!(digests(&reports), digests(&expected), "{said:?}");
    assert!(said.err.contains("connection lost: no answer within 3s, during grant"), "{said:?}");
}

/// What is not there is named, and what to do about it.
#[test]
fn a_block_that_is_not_there_is_named() {
    let folder = copied_shear();
    let plc = Plc::start(folder.path(), &["--s7", "127.0.0.1:0"]);
    let numbered = |options: &str| {
        let link = format!("system_words = true\ns7 = {{ {options} }}");
        edit(folder.path(), "scenario.toml", "system_words = true", &link);
        let said = typed(folder.path(), &["run", ".", "--gateway", &plc.gateway("s7://")]);
        edit(folder.path(), "scenario.toml", &link, "system_words = true");
        assert_eq!(said.code, Some(2), "{said:?}");
        said.err
    };
    insta::assert_snapshot!([numbered("db_to_plc = 7"), numbered("db_from_plc = 8, db_to_plc = 1")].join("----\n"));
}
