//! What strangers send to the lobby is answered in words and harms nobody.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use onescan_server::formation::Formation;
use onescan_server::mailbox::Mailbox;
use onescan_server::plan::Coupling;
use onescan_server::transport::tcp::Lobby;
use onescan_server::transport::tcp::participant::take_part;
use onescan_tests::run::{PATIENCE, loopback, run};
use onescan_tests::toy::{ring, ring_plan};
use onescan_tests::{at_ms, run::boxed};

pub(crate) fn frame(json: &str) -> Vec<u8> {
    let mut bytes = (json.len() as u32 + 1).to_le_bytes().to_vec();
    bytes.push(b'J');
    bytes.extend_from_slice(json.as_bytes());
    bytes
}

/// Sends `bytes` and gives all that the server answers until it closes, as text.
pub(crate) fn send(address: SocketAddr, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(bytes).unwrap();
    stream.shutdown(std::net::Shutdown::Write).unwrap();
    let mut answer = Vec::new();
    // The server may reset a connection with bytes it never read; what came before counts.
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

pub(crate) const HELLO: &str = r#"{"hello":{"protocol":{"min":1,"max":1},"role":"client","agent":"test"}}"#;

#[test]
fn garbage_in_the_lobby_does_not_keep_clients_out() {
    let plan = ring_plan(&Coupling::Parallel);
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).unwrap();
    let address = lobby.address();
    let cases = [
        (b"GET / HTTP/1.1\r\n\r\n".to_vec(), "over the limit"),
        (vec![0; 4], "cannot be 0 bytes long"),
        (frame("{}"), "not a message of this protocol"),
        (frame("[1, 2"), "not a message of this protocol"),
        (frame(r#"{"status":{}}"#), "the first message must be `hello`"),
        (frame(&HELLO.replace("\"min\":1,\"max\":1", "\"min\":7,\"max\":9")), "no common protocol version"),
        ([frame(HELLO), frame(r#"{"status":{}}"#)].concat(), "the second message of a client must be `join`"),
        ([frame(HELLO), frame(r#"{"join":{"name":"3","period_ns":1}}"#)].concat(), "is not a name"),
        ([frame(HELLO), frame(r#"{"join":{"name":"alpha","period_ns":0}}"#)].concat(), "nonzero"),
    ];
    for (bytes, answer) in cases {
        let said = send(address, &bytes);
        assert!(said.contains(answer), "{answer:?} is not in {said:?}");
    }
    // One who is silent, and one who leaves in the middle of a frame.
    let _silent = TcpStream::connect(address).unwrap();
    TcpStream::connect(address).unwrap().write_all(&frame(HELLO)[..9]).unwrap();

    let threads: Vec<_> = boxed(ring())
        .into_iter()
        .map(|mut client| std::thread::spawn(move || take_part(client.as_mut(), address)))
        .collect();
    let mut formation = Formation::new(plan);
    formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |_| true).unwrap();
    let outcome = run(formation.start().unwrap(), at_ms(100));
    for thread in threads {
        assert_eq!(thread.join().unwrap().unwrap(), outcome.end);
    }
}

#[test]
fn one_who_is_refused_leaves_the_place_free() {
    let plan = ring_plan(&Coupling::Parallel);
    let lobby = Lobby::open(loopback(), &plan, Mailbox::new()).unwrap();
    let address = lobby.address();
    let wrong = r#"{"join":{"name":"alpha","period_ns":10000000,"writes":[{"name":"beta.out","type":"ULINT"}]}}"#;
    let stranger = std::thread::spawn(move || send(address, &[frame(HELLO), frame(wrong)].concat()));
    let mut formation = Formation::new(plan);
    let mut waiting = 0;
    let waited = formation.admit_from(&lobby, PATIENCE, PATIENCE, &mut |missing| {
        assert_eq!(missing, "`alpha`, `beta`, `gamma`");
        waiting += 1;
        waiting < 3 || !stranger.is_finished()
    });
    assert!(waited.unwrap_err().to_string().starts_with("stopped while waiting for client `alpha`"));
    assert!(stranger.join().unwrap().contains("would be a second writer of signal `beta.out`"));
}

#[test]
fn a_silent_applicant_is_sent_away() {
    let lobby = Lobby::open(loopback(), &ring_plan(&Coupling::Parallel), Mailbox::new()).unwrap();
    let mut silent = TcpStream::connect(lobby.address()).unwrap();
    silent.set_read_timeout(Some(Duration::from_mins(1))).unwrap();
    let mut answer = Vec::new();
    silent.read_to_end(&mut answer).unwrap();
    assert!(String::from_utf8_lossy(&answer).contains("no answer within 5000 ms"));
}
