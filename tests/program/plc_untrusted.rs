//! Who is on the other side of a link need not mean well.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;

use crate::plc::Plc;
use crate::typed::{Said, copied_shear, digests, edit, onescan, run_shear, scenario, typed};

/// Bytes of the shear's block from the PLC, with the words about the PLC itself.
const BLOCK_BYTES: usize = 28;
const PASSWORD: &str = "ONESCAN_OPCUA_PASSWORD";

/// A PLC that sends the same block again and again.
fn parrot(block: [u8; BLOCK_BYTES]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        while let Ok((mut stream, _)) = listener.accept() {
            let mut taken = [0; 4096];
            while stream.write_all(&block).is_ok() && matches!(stream.read(&mut taken), Ok(1..)) {}
        }
    });
    format!("plc=tcp://{address}")
}

#[test]
fn a_plc_that_answers_nonsense_ends_the_session() {
    let mut block = [0; BLOCK_BYTES];
    block[9] = 77;
    let said = typed(&scenario("shear"), &["run", ".", "--gateway", &parrot(block)]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.out.contains("nonsense") && said.out.contains("SDSP_Answer is 77"), "{said:?}");
}

/// Blocks of another length, and a PLC that closes in the middle of one: the layouts do not agree.
#[test]
fn a_plc_with_another_layout_is_reported() {
    let folder = copied_shear();
    let short = "system_words = true\nreconnect_timeout = \"300ms\"";
    edit(folder.path(), "scenario.toml", "system_words = true", short);
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        while let Ok((mut stream, _)) = listener.accept() {
            // It may be gone again.
            let _ = stream.write_all(&[0; BLOCK_BYTES - 1]);
        }
    });
    let said = typed(folder.path(), &["run", ".", "--gateway", &format!("plc=tcp://{address}")]);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.out.contains("closed after 27 of the 28 bytes of a block"), "{said:?}");
}

#[test]
fn a_plc_is_not_upset_by_what_is_sent_to_it() {
    let (expected, _) = run_shear(&["--until", "1s"]);
    let mut plc = Plc::start(&scenario("shear"), &[]);
    for scheme in ["tcp://", "s7://", "modbus://", "opc.tcp://", "ads://"] {
        let gateway = plc.gateway(scheme);
        let address = gateway.rsplit("://").next().unwrap().to_owned();
        for seed in 0..20_u64 {
            let mut stream = TcpStream::connect(&address).unwrap();
            let mut state = seed;
            let noise = (0..seed * 997).map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33) as u8
            });
            // A server may close on what it does not understand.
            let _ = stream.write_all(&noise.collect::<Vec<u8>>());
        }
        assert!(plc.say("status").starts_with("RUN"));
        let (reports, said) = run_shear(&["--until", "1s", "--gateway", &gateway]);
        assert_eq!(digests(&reports), digests(&expected), "{scheme} {said:?}");
    }
}

/// A run of the shear in `folder` over OPC UA, with what the scenario says of the link.
fn over_opc_ua(folder: &Path, plc: &Plc, options: &str, password: &str) -> Said {
    let scenario = folder.join("scenario.toml");
    let text = std::fs::read_to_string(scenario_of_the_project()).unwrap();
    let text = text.replace("system_words = true\n", &format!("system_words = true\nopcua = {{ {options} }}\n"));
    std::fs::write(scenario, text).unwrap();
    let words = ["run", ".", "--format", "json", "--until", "1s", "--gateway", &plc.gateway("opc.tcp://")];
    onescan(folder).args(words).env(PASSWORD, password).output().unwrap().into()
}

fn scenario_of_the_project() -> std::path::PathBuf {
    scenario("shear").join("scenario.toml")
}

fn assert_refused(said: &Said) {
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("authentication refused"), "{said:?}");
}

fn assert_equal(said: &Said) {
    assert_eq!(said.code, Some(0), "{said:?}");
    let (expected, _) = run_shear(&["--until", "1s"]);
    let report = serde_json::from_str(&said.out).expect("a report");
    assert_eq!(digests(&[report]), digests(&expected));
}

#[test]
fn who_is_not_known_is_not_let_in() {
    let folder = copied_shear();
    let words = ["--opcua", "127.0.0.1:0", "--opcua-user", "operator"];
    let plain = typed(folder.path(), &[&["plc", "."], &words[..]].concat());
    assert_eq!(plain.code, Some(2), "{plain:?}");
    assert!(
        plain.err.contains("the password of user `operator` would come over the network in plain text"),
        "{plain:?}"
    );
    let permitted = [&words[..], &["--opcua-plain-password"]].concat();
    let plc = Plc::start_with(folder.path(), &permitted, PASSWORD, "right");
    let plain = over_opc_ua(folder.path(), &plc, "user = \"operator\"", "right");
    assert_eq!(plain.code, Some(2), "{plain:?}");
    assert!(plain.err.contains("the password of user `operator` would go over the network in plain text"), "{plain:?}");
    assert_refused(&over_opc_ua(folder.path(), &plc, "", "right"));
    assert_refused(&over_opc_ua(folder.path(), &plc, "plain_password = true, user = \"operator\"", "wrong"));
    assert_refused(&over_opc_ua(folder.path(), &plc, "plain_password = true, user = \"somebody\"", "right"));
    assert_equal(&over_opc_ua(folder.path(), &plc, "plain_password = true, user = \"operator\"", "right"));
}

/// What an engineer does with a certificate that was refused and is known.
fn trust_what_was_rejected(pki: &Path) {
    let rejected: Vec<_> = std::fs::read_dir(pki.join("rejected")).unwrap().map(|entry| entry.unwrap()).collect();
    assert!(!rejected.is_empty(), "nothing was rejected in {}", pki.display());
    for entry in rejected {
        std::fs::rename(entry.path(), pki.join("trusted").join(entry.file_name())).unwrap();
    }
}

#[test]
fn certificates_are_trusted_on_both_sides_or_there_is_no_session() {
    let folder = copied_shear();
    let [server, client] = ["server-pki", "client-pki"].map(|name| folder.path().join(name));
    let plc = Plc::start(folder.path(), &["--opcua", "127.0.0.1:0", "--opcua-pki", server.to_str().unwrap()]);
    let secured = "policy = \"Basic256Sha256\", pki = \"client-pki\"";
    // Without security nobody is let in.
    let said = over_opc_ua(folder.path(), &plc, "", "");
    assert_refused(&said);
    assert!(said.err.contains("no endpoint with policy None"), "{said:?}");
    // The server does not trust the client, then the client not the server.
    assert_refused(&over_opc_ua(folder.path(), &plc, secured, ""));
    trust_what_was_rejected(&server);
    assert_refused(&over_opc_ua(folder.path(), &plc, secured, ""));
    trust_what_was_rejected(&client);
    assert_equal(&over_opc_ua(folder.path(), &plc, secured, ""));
}
