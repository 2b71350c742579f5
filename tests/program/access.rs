//! Who may take part, and what a scenario may do: tokens, certificates, programs, files.

use std::io::{BufRead, BufReader};
use std::path::Path;

use crate::typed::{Said, begun, copied_shear, digests, edit, flat, onescan, run_shear, scenario, typed};

/// Where a session says that it listens.
pub(crate) fn listening_at(said: &mut impl BufRead) -> String {
    for line in said.lines() {
        let line = line.expect("text");
        if let Some(rest) = line.split("listening at ").nth(1) {
            return rest.split(' ').next().expect("an address").to_owned();
        }
    }
    panic!("it does not say where it listens");
}

/// A folder with a certificate for `hosts`, and the tokens `name=role`.
pub(crate) fn access(hosts: &[&str], tokens: &[(&str, &str)]) -> (tempfile::TempDir, Vec<String>) {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path().to_str().expect("text");
    let mut words = vec!["certificate", "new", "--access", folder];
    for host in hosts {
        words.extend(["--host", host]);
    }
    let said = typed(place.path(), &words);
    assert_eq!(said.code, Some(0), "{said:?}");
    let made = tokens.iter().map(|(name, role)| {
        let said = typed(place.path(), &["token", "new", name, "--role", role, "--access", folder]);
        assert_eq!(said.code, Some(0), "{said:?}");
        said.out.trim().to_owned()
    });
    let made = made.collect();
    (place, made)
}

#[test]
fn tokens_are_made_listed_and_revoked() {
    let (place, made) = access(&[], &[("anna", "operator"), ("cell-3", "client:plant")]);
    let folder = place.path().to_str().unwrap();
    assert!(made.iter().all(|token| token.starts_with("onescan_") && token.len() == 72) && made[0] != made[1]);
    let kept = std::fs::read_to_string(place.path().join("tokens.toml")).unwrap();
    assert!(made.iter().all(|token| !kept.contains(&token[8..])), "only hashes are kept: {kept}");
    let said = typed(place.path(), &["token", "list", "--access", folder, "--format", "json"]);
    let listed: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!((&listed[0]["name"], &listed[1]["role"]), (&"anna".into(), &"client:plant".into()));
    let again = typed(place.path(), &["token", "new", "anna", "--role", "viewer", "--access", folder]);
    assert!(again.code == Some(2) && again.err.contains("there is a token `anna` already"), "{again:?}");
    assert_eq!(typed(place.path(), &["token", "revoke", "anna", "--access", folder]).code, Some(0));
    let gone = typed(place.path(), &["token", "revoke", "anna", "--access", folder]);
    assert!(gone.code == Some(2) && gone.err.contains("has no token `anna`"), "{gone:?}");
    let people = typed(place.path(), &["token", "list", "--access", folder]).out;
    assert!(
        people.starts_with("cell-3 ") && people.contains("client:plant") && people.contains("until 20"),
        "{people}"
    );
    let second = typed(place.path(), &["certificate", "new", "--access", folder]);
    assert!(second.code == Some(2) && second.err.contains("exists"), "{second:?}");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(place.path().join("server-key.pem")).unwrap().permissions().mode();
        assert_eq!(mode & 0o77, 0, "nobody else reads the key");
    }
}

/// Certificates are revoked by their file or by their fingerprint, and a session does not begin with a list that it cannot read.
#[test]
fn certificates_are_revoked_and_listed() {
    let (place, _) = access(&[], &[]);
    let folder = place.path().to_str().unwrap();
    let certificate = |words: &[&str]| typed(place.path(), &[&["certificate"], words, &["--access", folder]].concat());
    // Any certificate will do: that of the session itself names nobody.
    let said = certificate(&["revoke", "server.pem"]);
    assert!(said.code == Some(0) && said.out.starts_with("revoked the certificate: "), "{said:?}");
    let fingerprint = said.out.trim().rsplit(' ').next().unwrap().to_owned();
    assert_eq!((fingerprint.len(), fingerprint.matches(':').count()), (95, 31), "{fingerprint}");
    for again in ["server.pem", fingerprint.as_str(), &fingerprint.replace(':', "").to_lowercase()] {
        let said = certificate(&["revoke", again]);
        assert!(said.code == Some(0) && said.out.contains("was revoked on 20"), "{said:?}");
    }
    let other = "00:".repeat(31) + "ff";
    assert_eq!(certificate(&["revoke", &other]).code, Some(0));
    let listed: serde_json::Value = serde_json::from_str(&certificate(&["revoked", "--format", "json"]).out).unwrap();
    assert_eq!(listed.as_array().map(Vec::len), Some(2), "{listed}");
    assert_eq!(listed[0]["sha256"], fingerprint);
    assert!(certificate(&["revoked"]).out.contains(&fingerprint));
    for (wrong, why) in [("missing.pem", "missing.pem"), ("tokens.toml", "there is no certificate in it")] {
        std::fs::write(place.path().join("tokens.toml"), "").unwrap();
        let said = certificate(&["revoke", wrong]);
        assert!(said.code == Some(2) && flat(&said.err).contains(why), "{said:?}");
    }
    std::fs::copy(place.path().join("ca.pem"), place.path().join("clients-ca.pem")).unwrap();
    let words = ["run", ".", "--until", "20ms", "--listen", "127.0.0.1:0", "--access", folder];
    assert_eq!(typed(&scenario("shear"), &words).code, Some(0));
    std::fs::write(place.path().join("revoked.toml"), "[[certificate]]\nsha256 = \"x\"\nrevoked = \"y\"\n").unwrap();
    let said = typed(&scenario("shear"), &words);
    assert!(said.code == Some(2) && flat(&said.err).contains("a fingerprint is 32 bytes"), "{said:?}");
}

#[test]
fn nobody_listens_to_the_world_by_accident() {
    let shear = scenario("shear");
    let said = typed(&shear, &["run", ".", "--until", "1s", "--listen", "0.0.0.0:0"]);
    assert_eq!(said.code, Some(2), "{said:?}");
    let text = flat(&said.err);
    assert!(text.contains("0.0.0.0:0 can be reached from other machines, and nobody has to show a token"), "{text}");
    assert!(text.contains("--access DIR") && text.contains("--listen-insecure"), "{text}");
    let open = typed(&shear, &["run", ".", "--until", "1s", "--listen", "0.0.0.0:0", "--listen-insecure"]);
    assert_eq!(open.code, Some(0), "{open:?}");
}

/// `onescan control` at `address` with these variables.
fn control(address: &str, wish: &str, variables: &[(&str, &str)]) -> Said {
    let mut command = onescan(&scenario("shear"));
    command.args(["control", address, wish]).envs(variables.iter().copied());
    command.output().expect("the program starts").into()
}

#[test]
fn a_session_with_tokens_starts_its_own_clients_and_lets_operators_in() {
    let (place, made) = access(&[], &[("anna", "operator"), ("wall", "viewer")]);
    let folder = place.path().to_str().unwrap();
    let ca = place.path().join("ca.pem");
    let words = ["run", ".", "--format", "json", "--until", "2s", "--pace", "1", "--transport", "tcp"];
    let listens = ["--listen", "127.0.0.1:0", "--access", folder];
    let mut server = begun(&scenario("shear"), &[&words[..], &listens].concat());
    let mut said = BufReader::new(server.stderr.take().unwrap());
    let address = listening_at(&mut said);
    let (ca, anna, wall) = (("ONESCAN_TLS_CA", ca.to_str().unwrap()), made[0].as_str(), made[1].as_str());
    let looks = control(&address, "status", &[ca, ("ONESCAN_TOKEN", wall)]);
    assert_eq!(looks.code, Some(0), "{looks:?}");
    for (wish, variables, why) in [
        ("stop", vec![ca, ("ONESCAN_TOKEN", wall)], "token `wall` lets its holder look, and change nothing"),
        ("stop", vec![ca], "this session lets nobody in without a token"),
        ("stop", vec![("ONESCAN_TOKEN", anna)], "this session speaks TLS only"),
        ("stop", vec![ca, ("ONESCAN_TOKEN", "secret")], "not a token"),
    ] {
        let sent_away = control(&address, wish, &variables);
        let text = flat(&sent_away.err);
        assert!(sent_away.code == Some(2) && text.contains(why), "{why}: {sent_away:?}");
        assert!(!text.contains("secret"), "a secret is not repeated");
    }
    for wish in ["pause", "step", "resume"] {
        let done = control(&address, wish, &[ca, ("ONESCAN_TOKEN", anna)]);
        assert_eq!(done.code, Some(0), "{done:?}");
    }
    let output = server.wait_with_output().unwrap();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let (undisturbed, _) = run_shear(&["--until", "2s"]);
    assert_eq!(digests(&[report]), digests(&undisturbed));
}

/// A shear whose plant is a program that writes its environment to a file and ends.
fn with_program(folder: &Path, extra: &str) {
    let command = "kind = \"external\"\ncommand = [\"sh\", \"-c\", \"env > seen.txt\"]";
    edit(folder, "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", command);
    edit(folder, "scenario.toml", "version = 1", &format!("version = 1\n{extra}"));
    // Its cases set parameters of the plant that is no more.
    std::fs::remove_file(folder.join("cases.toml")).expect("it has cases");
}

#[cfg(unix)]
#[test]
fn a_scenarios_program_sees_no_secrets() {
    let run = |extra: &str| {
        let shear = copied_shear();
        with_program(shear.path(), extra);
        let mut command = onescan(shear.path());
        command.args(["run", "."]).env("CI_SECRET", "s3cret").env("LICENSE_SERVER", "there");
        let said: Said = command.output().unwrap().into();
        assert!(
            said.err.contains("starting the scenario's program for client `plant`: sh -c env > seen.txt"),
            "{said:?}"
        );
        std::fs::read_to_string(shear.path().join("seen.txt")).unwrap()
    };
    let seen = run("");
    assert!(seen.contains("PATH=") && !seen.contains("s3cret") && !seen.contains("LICENSE_SERVER"), "{seen}");
    let seen = run("pass_env = [\"LICENSE_SERVER\"]");
    assert!(seen.contains("LICENSE_SERVER=there") && !seen.contains("s3cret"), "{seen}");
}

#[test]
fn programs_can_be_forbidden() {
    let shear = copied_shear();
    with_program(shear.path(), "");
    let reported = typed(shear.path(), &["test", "."]);
    assert!(
        flat(&reported.err).contains("tests of . start a program for client `plant`: sh -c env > seen.txt"),
        "{reported:?}"
    );
    assert!(shear.path().join("seen.txt").exists(), "it was started");
    std::fs::remove_file(shear.path().join("seen.txt")).unwrap();
    for words in [["run", ".", "--no-commands"], ["test", ".", "--no-commands"]] {
        let said = typed(shear.path(), &words);
        assert_ne!(said.code, Some(0), "{said:?}");
        let all = flat(&(said.out.clone() + &said.err));
        assert!(all.contains("which `--no-commands` forbids"), "{said:?}");
        assert!(!shear.path().join("seen.txt").exists(), "it was not started");
    }
}

#[test]
fn a_scenario_reads_its_own_folder() {
    let place = tempfile::tempdir().unwrap();
    let secret = place.path().join("secret.st");
    std::fs::write(&secret, "PROGRAM Main\nVAR password : STRING := 's3cret' END_VAR\n").unwrap();
    let shear = copied_shear();
    edit(shear.path(), "scenario.toml", "plc/shear.st", &secret.display().to_string().replace('\\', "/"));
    for command in ["run", "wiring"] {
        let said = typed(shear.path(), &[command, "."]);
        assert_eq!(said.code, Some(2), "{said:?}");
        let text = flat(&said.err);
        assert!(text.contains("is outside of the scenario's folder") && !text.contains("s3cret"), "{said:?}");
    }
    let allowed = typed(shear.path(), &["run", ".", "--allow-path", place.path().to_str().unwrap()]);
    assert!(allowed.err.contains("s3cret"), "it is read, and its mistake is shown: {allowed:?}");
}
