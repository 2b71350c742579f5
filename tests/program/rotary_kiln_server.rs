//! The server of the rotary kiln: it reads the last revolution out of the PLC, goes away, and finds it whole when it comes back.

use std::net::SocketAddr;

use ads::client::ReadRequest;
use ads::{AmsAddr, AmsNetId, Client, Device, Handle, Source, Timeouts};
use onescan_links::inspection::{Inspected, Inspection};
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::formation::Formation;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::time::VirtualTime;
use onescan_tests::at_ms;
use onescan_tests::run::loopback;

use crate::typed::{onescan, scenario};

/// Group of values by handle.
const BY_HANDLE: u32 = 0xF005;
/// Bytes of a row: SYN, 1024 points, the internal temperature.
const ROW: usize = 1026;
const ROWS: usize = 600;

/// What the server has read, all at one step boundary.
struct Read {
    revolutions: i32,
    rows: i16,
    last: Vec<u8>,
    sum: u32,
}

fn client(address: SocketAddr) -> Client {
    let source = Source::Addr(AmsAddr::new(AmsNetId::new(127, 0, 0, 1, 1, 1), 40_001));
    let timeouts = Timeouts::new(std::time::Duration::from_secs(30));
    Client::new(address, timeouts, source).expect("it listens")
}

fn plc(client: &Client) -> Device<'_> {
    client.device(AmsAddr::new(AmsNetId::new(127, 0, 0, 1, 1, 1), 851))
}

fn read(address: SocketAddr) -> Read {
    let client = client(address);
    let plc = plc(&client);
    let handles =
        ["GV_Revolutions", "GV_Rows", "gv_last", "GV_Sum"].map(|name| Handle::new(plc, name).expect("a name"));
    let (mut revolutions, mut rows, mut last, mut sum) = ([0; 4], [0; 2], vec![0; ROWS * ROW], [0; 4]);
    let buffers: [&mut [u8]; 4] = [&mut revolutions, &mut rows, &mut last, &mut sum];
    let mut requests: Vec<_> =
        handles.iter().zip(buffers).map(|(handle, buffer)| ReadRequest::new(BY_HANDLE, handle.raw(), buffer)).collect();
    plc.read_multi(&mut requests).expect("they are there");
    assert!(requests.iter().all(|request| request.data().is_ok()));
    drop(requests);
    Read {
        revolutions: i32::from_le_bytes(revolutions),
        rows: i16::from_le_bytes(rows),
        last,
        sum: u32::from_le_bytes(sum),
    }
}

impl Read {
    /// Every line of the revolution is there, and the PLC's sum over it is that of what was read.
    fn is_whole(&self) {
        assert_eq!(self.rows, 100);
        let rows = || self.last.chunks(ROW).take(100);
        assert!(rows().all(|row| (row[0], row[257]) == (0x16, 26)), "SYN, and 26 degrees inside");
        let points = rows().flat_map(|row| &row[1..=256]);
        assert!(points.clone().all(|point| *point > 0));
        assert_eq!(points.fold(1, |sum, point| (sum * 31 + u32::from(*point)) % 16_777_213), self.sum);
    }
}

fn begun(scenario: &Scenario) -> Lockstep {
    let mut formation = Formation::new(scenario.plan().clone());
    for name in scenario.plan().clients() {
        match scenario.member(name).expect("it is right") {
            Member::Plant(client) | Member::Plc(client) | Member::Gateway(client) => {
                formation.join(client).expect("the plan has a place");
            }
            Member::External(_) | Member::Seated { .. } => panic!("{name} comes from elsewhere"),
        }
    }
    formation.start().expect("all have joined")
}

/// The session goes on, step by step, until the server has read.
fn read_meanwhile(session: &mut Lockstep, address: SocketAddr) -> Read {
    let reader = std::thread::spawn(move || read(address));
    while !reader.is_finished() {
        let next = session.session().t_v() + session.session().step();
        assert_eq!(session.run_to(next).expect("nothing is recorded"), Reached::Boundary);
    }
    reader.join().expect("it has read")
}

#[test]
fn a_server_that_was_gone_for_an_hour_finds_the_last_revolution_whole() {
    let mut kiln = Scenario::load(&scenario("rotary-kiln").join("tcp.toml")).expect("a scenario");
    kiln.show_memories();
    let mut session = begun(&kiln);
    session.run_to(at_ms(140_000)).expect("nothing is recorded");
    let name = kiln.plcs().next().expect("a PLC").name.clone();
    let compiled = kiln.compiled_plc(&name).expect("it compiles").expect("a soft PLC");
    let find = move |path: &str| compiled.application.variable(path).ok();
    let plcs = vec![Inspected { client: name, find: Box::new(find) }];
    let inspection = Inspection::serve(loopback(), session.published(), plcs).expect("a free port");

    let before = read_meanwhile(&mut session, inspection.address());
    before.is_whole();
    let gone = session.session().t_v();
    let back = VirtualTime::from_nanos(gone.as_nanos() + 3_600_000_000_000);
    session.run_to(back).expect("nothing is recorded");
    let after = read_meanwhile(&mut session, inspection.address());
    after.is_whole();
    // 3,600 s of 60.24 s each, and what passed while it read
    assert!(after.revolutions - before.revolutions >= 59, "{} {}", before.revolutions, after.revolutions);

    let end = VirtualTime::from_nanos(session.session().t_v().as_nanos() + 1_000_000_000);
    session.run_to(end).expect("nothing is recorded");
    let mut alone = begun(&kiln);
    alone.run_to(end).expect("nothing is recorded");
    assert_eq!(session.digest(), alone.digest(), "whoever reads leaves no trace");
}

#[test]
fn variables_of_a_session_are_read_by_a_client_that_others_have_made() {
    let mut child = onescan(&scenario("rotary-kiln"))
        .args(["run", "tcp.toml", "--ads", "127.0.0.1:0", "--until", "24h", "--pace", "1"])
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it runs");
    let lines = std::io::BufRead::lines(std::io::BufReader::new(child.stderr.take().expect("piped")));
    let mut lines = lines.map_while(Result::ok);
    let reported = lines.find_map(|line| line.split_once("ads://").map(|(_, address)| address.trim().to_owned()));
    let address: SocketAddr = reported.expect("it says where it serves").parse().expect("an address");
    let client = client(address);
    let plc = plc(&client);
    assert_eq!(plc.get_info().expect("a device").name, "onescan");
    let points = Handle::new(plc, "GV_Points").expect("a name");
    assert_eq!(points.read_value::<i16>().expect("an INT"), 256);
    let mut limits = [0; 8];
    Handle::new(plc, "GV_Limit").expect("an array").read(&mut limits).expect("as a whole");
    assert_eq!(limits, [155; 8]);
    let refused = [
        points.write_value(&1_i16).expect_err("it is only read").to_string(),
        points.read_value::<i64>().expect_err("it has two bytes").to_string(),
        Handle::new(plc, "GV_Pionts").map(|handle| handle.raw()).expect_err("no such name").to_string(),
        client
            .device(AmsAddr::new(AmsNetId::new(127, 0, 0, 1, 1, 1), 852))
            .get_info()
            .map(|info| info.name)
            .expect_err("there is one PLC")
            .to_string(),
    ];
    child.kill().expect("it runs");
    child.wait().expect("it has run");
    insta::assert_snapshot!(refused.join("\n"));
}
