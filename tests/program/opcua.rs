//! Clients and operators that have nothing but an OPC UA client, written on `asyncua`, in sessions of this program.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::access::access;
use crate::typed::{Said, copied_shear, digests, edit, onescan, run_shear, scenario, typed};
use crate::venv::python;

/// The Python that PLCs of others run on, too.
fn interpreter() -> std::path::PathBuf {
    python("plc-peers-1", &["asyncua==2.1.0", "pymodbus==3.16.1", "python-snap7==3.3.0"])
}

fn script(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/opcua").join(name)
}

/// A script that takes an endpoint and more words.
fn begun(name: &str, words: &[&str]) -> Child {
    let mut command = Command::new(interpreter());
    command.arg(script(name)).args(words).env("PYTHONDONTWRITEBYTECODE", "1");
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("Python starts")
}

/// A session of the shear that others join over OPC UA.
struct Server {
    child: Child,
    url: String,
    said: BufReader<std::process::ChildStderr>,
}

impl Server {
    fn start(folder: &Path, words: &[&str]) -> Self {
        let all = [&["run", ".", "--format", "json", "--opcua", "127.0.0.1:0"], words].concat();
        let mut child = onescan(folder).args(all).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut said = BufReader::new(child.stderr.take().expect("piped"));
        let mut line = String::new();
        said.read_line(&mut line).expect("it speaks");
        let url = line.trim().rsplit(' ').next().expect("an endpoint").to_owned();
        assert!(url.starts_with("opc.tcp://127.0.0.1:"), "{line}");
        Self { child, url, said }
    }

    /// Ends it before anybody has taken part.
    fn stop(&mut self) {
        self.child.kill().expect("it runs");
        self.child.wait().expect("it ends");
    }

    fn end(mut self) -> Said {
        let mut err = String::new();
        self.said.read_to_string(&mut err).expect("text");
        let output = self.child.wait_with_output().expect("it ends");
        Said { err, ..Said::from(output) }
    }
}

fn report(said: &Said) -> serde_json::Value {
    serde_json::from_str(&said.out).unwrap_or_else(|_| panic!("{said:?}"))
}

/// A peer that ends well, and what it says.
fn ended(peer: Child) -> String {
    let said = Said::from(peer.wait_with_output().expect("it ends"));
    assert_eq!(said.code, Some(0), "{said:?}");
    said.out
}

/// A PLC in Python over OPC UA in the soft PLC's place: the same bits, however it waits for its grants.
#[test]
fn a_plc_with_an_opc_ua_client_equals_the_soft_plc() {
    let (expected, _) = run_shear(&["--until", "2s"]);
    for how in ["call", "poll", "subscribe"] {
        let server = Server::start(&scenario("shear"), &["--until", "2s", "--opcua-client", "plc"]);
        let peer = begun("participant.py", &[&server.url, "plc", how]);
        let said = server.end();
        assert_eq!(said.code, Some(0), "{how}: {said:?}");
        assert_eq!(digests(&[report(&said)]), digests(&expected), "{how}");
        assert_eq!(ended(peer).trim(), "completed at t_v = 2.000 s", "{how}");
    }
}

/// The same plant in Python over the native protocol and over OPC UA, in a scenario that says so, run after run.
#[test]
fn a_plant_with_an_opc_ua_client_is_what_it_is_over_tcp() {
    let (native, opcua) = (copied_shear(), copied_shear());
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../clients/python");
    let plant = package.join("examples/shear.py");
    let built_in = "kind = \"plant\"\nscene = \"plant.toml\"";
    let external = format!(
        "kind = \"external\"\ncommand = [\"python3\", \"-B\", \"{}\", \"--server\", \"{{server}}\"]",
        plant.display()
    );
    edit(native.path(), "scenario.toml", built_in, &external);
    let command = [interpreter(), script("participant.py")].map(|path| format!("\"{}\"", path.display())).join(", ");
    let client = format!(
        "kind = \"opc-ua\"\nreads = [\"Actuator_1_Up\", \"Actuator_1_Down\", \"Actuator_2_Up\", \"Actuator_2_Down\"]\n\
         command = [{command}, \"{{server}}\", \"plant\", \"poll\"]"
    );
    edit(opcua.path(), "scenario.toml", built_in, &client);
    let run = |folder: &Path, runs: &str| {
        let words = ["run", ".", "--format", "json", "--until", "2s", "--runs", runs];
        let mut command = onescan(folder);
        command.args(words).env("PYTHONPATH", package.join("src")).env("PYTHONDONTWRITEBYTECODE", "1");
        let said = Said::from(command.output().expect("the program starts"));
        assert_eq!(said.code, Some(0), "{said:?}");
        let reports: Vec<_> = said.out.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        digests(&reports)
    };
    let expected = run(native.path(), "1").remove(0);
    assert_eq!(run(opcua.path(), "2"), vec![expected; 2]);
}

/// Answers that are doubled, late or made up, outputs out of turn, wrong values, somebody else's place: each is
/// refused by a status of its own, and the digest is as if none of it had been.
#[test]
fn what_is_wrong_is_refused_and_changes_nothing() {
    let (expected, _) = run_shear(&["--until", "500ms"]);
    let server = Server::start(&scenario("shear"), &["--until", "500ms", "--opcua-client", "plc"]);
    let peer = begun("misbehaving.py", &[&server.url]);
    let said = server.end();
    let refused = ended(peer);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert_eq!(digests(&[report(&said)]), digests(&expected));
    insta::assert_snapshot!(refused);
}

/// A client that is killed, that leaves, that says it cannot go on, or that does not come.
#[test]
fn a_client_that_fails_is_reported_by_name() {
    for (how, patience, reported) in [
        ("dies", "60s", "its OPC UA connection or session has ended while grant "),
        ("hangs", "3s", "is not done within 3 s: its OPC UA client is dead, hangs or does not write `Done`"),
        ("leaves", "60s", "its OPC UA connection or session has ended while grant "),
        ("fault", "60s", "client `plc` failed in state run at t_v = 0.200 s: the valve is stuck"),
    ] {
        let words = ["--until", "1h", "--opcua-client", "plc", "--reply-timeout", patience];
        let server = Server::start(&scenario("shear"), &words);
        let peer = begun("failing.py", &[&server.url, how]);
        let said = server.end();
        assert_eq!(said.code, Some(3), "{how} {said:?}");
        let error = report(&said)["error"].as_str().unwrap_or_default().to_owned();
        assert!(error.starts_with("client `plc` failed in state run at t_v = ") && error.contains(reported), "{error}");
        // It has been ended, or ends by itself.
        drop(peer.wait_with_output());
    }
    let words = ["run", ".", "--opcua-client", "plc", "--join-timeout", "100ms"];
    let said = typed(&scenario("shear"), &words);
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("client `plc` did not join within 0.1 s"), "{said:?}");
}

/// A client that has taken all sessions dies: they are free again after what the server said, and the next client takes part.
#[test]
fn the_sessions_of_a_dead_client_are_free_again() {
    let words = ["--until", "100ms", "--opcua-client", "plc", "--join-timeout", "5min"];
    let server = Server::start(&scenario("shear"), &words);
    assert_eq!(ended(begun("flood.py", &[&server.url])).trim(), "512 15000.0");
    let mut refused = 0;
    loop {
        let said = Said::from(begun("participant.py", &[&server.url, "plc", "call"]).wait_with_output().unwrap());
        if said.code == Some(0) {
            break;
        }
        refused += 1;
        assert!(said.err.contains("BadTooManySessions") && refused < 100, "{said:?}");
    }
    assert!(refused > 0, "none was free at first");
    let said = server.end();
    assert_eq!(said.code, Some(0), "{said:?}");
}

/// Pause, single steps, a force, a reset and the end by an operator with an OPC UA client: recorded, and repeated to
/// the same digest.
#[test]
fn an_operator_with_an_opc_ua_client_is_data_too() {
    let folder = copied_shear();
    let server = Server::start(folder.path(), &["--until", "1h", "--pace", "20", "--record", "live"]);
    let peer = begun("panel.py", &[&server.url]);
    let said = server.end();
    insta::assert_snapshot!(ended(peer));
    let live = report(&said);
    assert_eq!(live["status"], "stopped", "{said:?}");
    let words = ["run", ".", "--format", "json", "--until", "1h", "--replay-operator", "live"];
    let again = report(&typed(folder.path(), &words));
    assert_eq!((&again["digest"], &again["steps"]), (&live["digest"], &live["steps"]));
}

/// The start logic holds once somebody writes over OPC UA; without that, Start alone lets no step come.
#[test]
fn a_session_that_waits_for_its_start_is_started() {
    let folder = copied_shear();
    edit(folder.path(), "scenario.toml", "version = 1\n", "version = 1\nstart = \"Strokes < 0\"\n");
    let server = Server::start(folder.path(), &["--until", "100ms", "--record", "live"]);
    let peer = begun("starter.py", &[&server.url, "Strokes", "-5"]);
    let said = server.end();
    assert_eq!(ended(peer), "held, state, steps [True, 1, 0]\nended after 10\n");
    assert!(said.err.contains("the session starts when this holds: Strokes < 0"), "{said:?}");
    let live = report(&said);
    let words = ["run", ".", "--format", "json", "--until", "100ms", "--replay-operator", "live"];
    assert_eq!(report(&typed(folder.path(), &words))["digest"], live["digest"]);
}

/// The published node set is taken in by a server of others, and says what a session serves.
#[test]
fn the_published_node_set_is_what_is_served() {
    let server = Server::start(&scenario("shear"), &["--until", "1h", "--pace", "1"]);
    let nodeset = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/opcua/onescan.lockstep.NodeSet2.xml");
    let peer = begun("validate.py", &[&nodeset.to_string_lossy(), &server.url]);
    let said = Said::from(peer.wait_with_output().expect("it ends"));
    let Server { mut child, .. } = server;
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.out.ends_with("nodes are the same\n"), "{said:?}");
}

#[test]
fn who_is_not_known_is_not_let_in() {
    let words = ["--until", "1s", "--opcua-client", "plc", "--opcua-user", "panel", "--join-timeout", "5min"];
    let plain = [&["run", ".", "--format", "json", "--opcua", "127.0.0.1:0"], &words[..]].concat();
    let refused = typed(&scenario("shear"), &plain);
    assert_eq!(refused.code, Some(2), "a password in plain text: {refused:?}");
    assert!(refused.err.contains("--opcua-plain-password"), "{refused:?}");
    let all = [&plain[..], &["--opcua-plain-password"]].concat();
    let without = typed(&scenario("shear"), &all);
    assert_eq!(without.code, Some(2), "a user without a password: {without:?}");
    let mut command = onescan(&scenario("shear"));
    command.args(all).env("ONESCAN_OPCUA_PASSWORD", "right").stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().expect("piped"));
    let mut line = String::new();
    said.read_line(&mut line).expect("it speaks");
    let url = line.trim().rsplit(' ').next().expect("an endpoint").to_owned();
    let peer = begun("participant.py", &[&url, "plc", "call"]);
    let anonymous = Said::from(peer.wait_with_output().expect("it ends"));
    assert_ne!(anonymous.code, Some(0));
    assert!(
        anonymous.err.contains("BadIdentityToken") || anonymous.err.contains("BadUserAccessDenied"),
        "{anonymous:?}"
    );
    let known = url.replace("opc.tcp://", "opc.tcp://panel:right@");
    ended(begun("participant.py", &[&known, "plc", "call"]));
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

/// Nobody has joined in time, but somebody tried: who, and why not.
#[test]
fn who_was_refused_is_named_when_nobody_has_joined() {
    let words = ["--opcua-client", "plc", "--opcua-user", "panel", "--opcua-plain-password", "--join-timeout", "40s"];
    let mut command = onescan(&scenario("shear"));
    command.args(["run", ".", "--opcua", "127.0.0.1:0"]).args(words).env("ONESCAN_OPCUA_PASSWORD", "right");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().expect("piped"));
    let mut line = String::new();
    said.read_line(&mut line).expect("it speaks");
    let url = line.trim().rsplit(' ').next().expect("an endpoint").replace("opc.tcp://", "opc.tcp://panel:wrong@");
    let peer = begun("participant.py", &[&url, "plc", "call"]);
    assert_ne!(Said::from(peer.wait_with_output().expect("it ends")).code, Some(0));
    assert_eq!(child.wait().unwrap().code(), Some(3));
    let mut rest = String::new();
    said.read_to_string(&mut rest).expect("text");
    // A long message is broken into lines.
    let reported = crate::typed::flat(&rest);
    assert!(
        reported.contains("did not join within 40 s; somebody tried and was refused: user `panel` over OPC UA"),
        "{rest}"
    );
    assert!(!rest.contains("ERROR"), "{rest}");
}

/// A certificate that was made for another application lets nobody take part, unless that is asked for.
#[test]
fn a_certificate_for_another_application_is_refused() {
    for (more, uri, reported) in [
        (&[][..], "urn:a:panel", "Good"),
        (&[], "urn:another", "BadCertificateUriInvalid"),
        (&["--opcua-foreign-uri"], "urn:another", "Good"),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let text = |path: std::path::PathBuf| path.to_str().expect("text").to_owned();
        let (pki, own) = (text(folder.path().join("pki")), text(folder.path().to_owned()));
        let words = ["--opcua-client", "plc", "--join-timeout", "5min", "--opcua-pki", &pki, "--opcua-trust"];
        let mut server = Server::start(&scenario("shear"), &[&words[..], more].concat());
        assert_eq!(
            ended(begun("stranger.py", &[&server.url, "session", &own, uri])).trim(),
            reported,
            "{more:?} {uri}"
        );
        server.stop();
        let folder = tempfile::tempdir().expect("a folder");
        let (pki, own) = (text(folder.path().join("pki")), text(folder.path().to_owned()));
        let plc = crate::plc::Plc::start(&scenario("shear"), &[&["--opcua-pki", &pki, "--opcua-trust"], more].concat());
        let url = plc.gateway("opc.tcp://").rsplit('=').next().expect("a URL").to_owned();
        assert_eq!(ended(begun("stranger.py", &[&url, "plc", &own, uri])).trim(), reported, "{more:?} {uri}");
    }
}

/// Tokens over OPC UA: an operator's does everything, a viewer's reads, a client's and strangers' come to nothing.
#[test]
fn tokens_are_good_for_what_they_say() {
    let (place, made) = access(&[], &[("anna", "operator"), ("wall", "viewer"), ("cell", "client:plc")]);
    let folder = place.path().to_str().unwrap();
    let words = ["--opcua-client", "plc", "--access", folder, "--opcua-plain-password"];
    let mut server = Server::start(&scenario("shear"), &words);
    let heard = |name: &str, token: &str| {
        let said = ended(begun("holder.py", &[&server.url, name, token]));
        said.lines().map(str::to_owned).collect::<Vec<_>>().join("; ")
    };
    let [operator, viewer, client] = [&made[0], &made[1], &made[2]];
    assert_eq!(heard("wall", viewer), "read 10000000; Pause BadUserAccessDenied; Start BadUserAccessDenied");
    for (name, token) in [("cell", client), ("anna", viewer), ("anna", &operator.replace(&operator[60..], "00"))] {
        let said = heard(name, token);
        assert!(said.starts_with("sent away Bad"), "{name}: {said}");
    }
    assert_eq!(heard("anna", operator), "read 10000000; Pause Good; Start Good");
    server.stop();
}

#[test]
fn options_that_contradict_each_other_are_reported() {
    let reported = |words: &[&str]| {
        let said = typed(&scenario("shear"), &[&["run", "."], words].concat());
        assert_eq!(said.code, Some(2), "{said:?}");
        said.err
    };
    let all = [
        reported(&["--opcua-client", "plnat"]),
        reported(&["--opcua-client", "plc", "--gateway", "plc"]),
        reported(&["--opcua-client", "plc", "--mode", "freewheel"]),
        reported(&["--opcua", "127.0.0.1:0", "--mode", "freewheel"]),
    ];
    insta::assert_snapshot!(all.join("----\n"));
}
