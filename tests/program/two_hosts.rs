//! A session over two hosts: two network namespaces with a cable between them.
//!
//! Namespaces take rights that not every machine gives. Where they cannot be made the test says so and is skipped, unless
//! `ONESCAN_REQUIRE_NETNS` is set, as CI does.

use std::io::BufReader;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::access::{access, listening_at};
use crate::typed::{Said, copied_shear, digests, edit, run_shear, scenario};

const SERVER: &str = "10.213.77.1";
const CLIENT: &str = "10.213.77.2";

/// Two namespaces, named for this process, that are removed with it.
struct Hosts {
    server: String,
    client: String,
}

fn ip(words: &[&str]) -> Result<(), String> {
    let output = Command::new("ip").args(words).output().map_err(|error| format!("ip: {error}"))?;
    if output.status.success() { Ok(()) } else { Err(String::from_utf8_lossy(&output.stderr).into_owned()) }
}

impl Hosts {
    fn new() -> Result<Self, String> {
        let number = std::process::id();
        let hosts = Self { server: format!("onescan-s{number}"), client: format!("onescan-c{number}") };
        let (server, client) = (hosts.server.as_str(), hosts.client.as_str());
        ip(&["netns", "add", server])?;
        ip(&["netns", "add", client])?;
        ip(&["-n", server, "link", "add", "veth0", "type", "veth", "peer", "name", "veth0", "netns", client])?;
        for (host, address) in [(server, SERVER), (client, CLIENT)] {
            ip(&["-n", host, "address", "add", &format!("{address}/24"), "dev", "veth0"])?;
            ip(&["-n", host, "link", "set", "veth0", "up"])?;
            ip(&["-n", host, "link", "set", "lo", "up"])?;
        }
        Ok(hosts)
    }

    /// The program on one of the hosts.
    fn onescan(host: &str, folder: &Path) -> Command {
        let mut command = Command::new("ip");
        command.args(["netns", "exec", host, env!("CARGO_BIN_EXE_onescan-under-test")]);
        command.current_dir(folder).env_remove("ONESCAN_LOG").env("NO_COLOR", "1");
        command
    }
}

impl Drop for Hosts {
    fn drop(&mut self) {
        for host in [&self.server, &self.client] {
            // What was not made is not there to be removed.
            let _ = ip(&["netns", "delete", host]);
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn over_two_hosts_the_digest_is_the_same() {
    let hosts = match Hosts::new() {
        Ok(hosts) => hosts,
        Err(why) => {
            assert!(std::env::var_os("ONESCAN_REQUIRE_NETNS").is_none(), "no network namespaces: {why}");
            return eprintln!("skipped: network namespaces cannot be made here: {why}");
        }
    };
    let (place, made) = access(&[SERVER], &[("cell", "client:plant"), ("anna", "operator")]);
    let shear = copied_shear();
    edit(shear.path(), "scenario.toml", "kind = \"plant\"\nscene = \"plant.toml\"", "kind = \"external\"");
    let mut server = Hosts::onescan(&hosts.server, shear.path());
    server.args(["run", ".", "--format", "json", "--until", "3s", "--listen", &format!("{SERVER}:0"), "--access"]);
    let mut server = server.arg(place.path()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(server.stderr.take().unwrap());
    let address = listening_at(&mut said);
    assert!(address.starts_with(SERVER), "{address}");

    let ca = place.path().join("ca.pem");
    let from_there = |words: &[&str], token: Option<&str>| -> Said {
        let mut command = Hosts::onescan(&hosts.client, &scenario("shear"));
        command.args(words).env("ONESCAN_TLS_CA", &ca).envs(token.map(|token| ("ONESCAN_TOKEN", token)));
        command.output().expect("ip starts it").into()
    };
    let stranger = from_there(&["join", ".", "plant", "--server", &address], None);
    assert!(stranger.code == Some(2) && stranger.err.contains("lets nobody in without a token"), "{stranger:?}");
    let wrong = from_there(&["join", ".", "plant", "--server", &address], Some(&made[1]));
    assert!(wrong.code == Some(2) && wrong.err.contains("good for `operator`"), "{wrong:?}");
    let status = from_there(&["control", &address], Some(&made[1]));
    assert!(status.code == Some(0) && status.out.contains("in state start"), "{status:?}");
    let plant = from_there(&["join", ".", "plant", "--server", &address], Some(&made[0]));
    assert_eq!(plant.code, Some(0), "{plant:?}");

    let output = server.wait_with_output().unwrap();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let (here, _) = run_shear(&["--until", "3s"]);
    assert_eq!(digests(&[report]), digests(&here), "wherever its clients are");
}
