//! What describes sessions, and who takes part in them.

use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};

use onescan_links::gateway::listing::Listing;
use onescan_runner::access::certificate;
use onescan_runner::access::folder::{CERTIFICATE, Folder, KEY, TOKENS};
use onescan_scenario::Scenario;
use onescan_scenario::case::catalogue::Catalogue;
use onescan_scenario::expect::{Judge, TraceEnd};
use onescan_scenario::file::ClientFile;
use onescan_scenario::report::{Measures, Meter};
use onescan_server::access::{Day, Holder};
use onescan_server::signal::ClientName;
use onescan_server::wire::message::Role;

use super::{Prepared, files, seed, shear};

/// `scenario.toml`: read and checked, with all of its clients but those that would call a PLC.
pub(super) fn scenario(scratch: &Path) -> Prepared {
    let folder = shear(scratch);
    let mut seeds = files("scenarios", &["scenario.toml"]);
    seeds.extend(files("docs", &["scenario.toml"]));
    Prepared::new(seeds, move |input| {
        write(&folder, "scenario.toml", input);
        let Ok(scenario) = Scenario::load(&folder) else { return false };
        for (name, client) in &scenario.file().clients {
            match client.get_ref() {
                ClientFile::Gateway { .. } => drop(scenario.agreement(name).map(|agreed| agreed.exchanged())),
                _ => drop(scenario.member(name)),
            }
        }
        scenario.measures().is_none_or(is_reported)
    })
}

/// Whether there is a report of 700 images of a run that was never.
fn is_reported(measures: &Measures) -> bool {
    let mut meter = Meter::new(measures);
    let sizes: Vec<usize> = measures.signals().map(|(_, ty)| ty.size()).collect();
    for step in 0..700_u64 {
        let byte = |column: usize| u8::from((step * 7 + column as u64 * 13) % (31 + column as u64) < 9);
        let image: Vec<Vec<u8>> = sizes.iter().enumerate().map(|(column, size)| vec![byte(column); *size]).collect();
        meter.push(step * 10_000_000, image.iter().map(Vec::as_slice));
    }
    meter.report().is_some()
}

/// `cases.toml` of the shear.
pub(super) fn cases(scratch: &Path) -> Prepared {
    let folder = shear(scratch);
    let scenario = Scenario::load(&folder).expect("the shear");
    Prepared::new(files("scenarios", &["cases.toml"]), move |input| {
        write(&folder, "cases.toml", input);
        let Ok(catalogue) = Catalogue::load(&folder) else { return false };
        let tried = catalogue.cases().iter().take(20);
        tried.filter(|case| scenario.clone().with_case(&catalogue, case).is_ok()).count() > 0
    })
}

/// A formula on the signals of the shear, judged over 700 samples of a run that was never.
pub(super) fn expectation(scratch: &Path) -> Prepared {
    let folder = shear(scratch);
    let text = std::fs::read_to_string(folder.join("scenario.toml")).expect("the shear");
    let seeds = [
        "always[0,3s] (rose(Sensor_1) implies within 200ms abs(Position_1 - 100 mm) / 2 < 5 mm) until[0,1s] Aligned",
        "eventually[10ms,2s] (Sensor_1 and not Sensor_2) or historically[0,100ms] Position_1 >= 0.1 m",
        "always (fell(Sensor_2) implies (Sensor_1 since[0,500ms] once Sensor_2))",
        "eventually always[0,100ms] (Position_1 <= 3 mm iff rate(Position_2) > -1e-3)",
        "always (Sensor_1 implies eventually (Sensor_2 and historically not Sensor_1))",
        "always max(Position_1, `Position_2`) + 2 * -min(Position_1, 0.1 m) <= 1e3 m and for 1s changed(Aligned)",
    ];
    let seeds = seeds.iter().map(|formula| formula.as_bytes().to_vec()).collect();
    let mut prepared = Prepared::new(seeds, move |input| {
        let formula = serde_json::to_string(&String::from_utf8_lossy(input)).expect("a text");
        write(
            &folder,
            "scenario.toml",
            format!("{text}\n[[expect]]\nname = \"new\"\nformula = {formula}\n").as_bytes(),
        );
        let Ok(scenario) = Scenario::load(&folder) else { return false };
        let expectations = scenario.expectations();
        let columns = expectations.signals.len();
        let mut judge = Judge::new(expectations.named.iter().map(|(_, each)| each.clone()), columns);
        for step in 0..700_u64 {
            let value = |column: usize| f64::from(u8::from((step * 7 + column as u64 * 13) % (31 + column as u64) < 9));
            judge.push(step * 10_000_000, (0..columns).map(value));
        }
        judge.finish(TraceEnd::Complete).len() == expectations.named.len()
    });
    prepared.words = &[
        "always",
        "eventually",
        "until",
        "since",
        "within",
        "for",
        "implies",
        "iff",
        "rate",
        "rose",
        "fell",
        "mm",
        "deg",
        "bar",
        "°C",
    ];
    prepared
}

/// The mapping of the shear's gateway in a file of its own.
pub(super) fn link(scratch: &Path) -> Prepared {
    let folder = shear(scratch);
    let scenario = Scenario::load(&folder).expect("the shear");
    let plc = ClientName::new("plc").expect("a name");
    let modbus = String::from_utf8(seed("link.toml")).expect("a text");
    let others = ["tcp://127.0.0.1:1", "s7://127.0.0.1:1/0/1", "ads://127.0.0.1:1", "opc.tcp://127.0.0.1:1"];
    let of = |url: &str| {
        let head = modbus.split("[clients.plc.gateway.map]").next().unwrap_or_default();
        head.replace("modbus://127.0.0.1:1502", url).into_bytes()
    };
    let mut seeds: Vec<_> = others.into_iter().map(of).collect();
    let parts = "[clients.plc.gateway.map]\nSDSP_Answer = \"8.0-7 + 9.0-3+9.4-7\"\n[clients.plc.gateway.layout]\nreserve_zero = false\n";
    seeds.push([of("tcp-listen://127.0.0.1:1"), parts.as_bytes().to_vec()].concat());
    seeds.push(modbus.clone().into_bytes());
    Prepared::new(seeds, move |input| {
        let path = write(&folder, "link.toml", input);
        let mut scenario = scenario.clone();
        if scenario.commission(&plc, Some(path.display().to_string())).is_err() {
            return false;
        }
        let Ok(agreed) = scenario.agreement(&plc) else { return false };
        let _ = agreed.settings.patience();
        Listing::new(&agreed.settings, &agreed.exchange).is_ok()
    })
}

/// Tokens as they are kept, and one that is shown.
pub(super) fn tokens(scratch: &Path) -> Prepared {
    let folder = scratch.join("tokens");
    std::fs::create_dir_all(&folder).expect("a scratch folder");
    let hash = onescan_server::access::TokenHash::of("x");
    let text = format!(
        "[[token]]\nname = \"anna\"\nrole = \"operator\"\nexpires = \"2030-01-31\"\nhash = \"{hash}\"\n\n\
         [[token]]\nname = \"b@c\"\nrole = \"client:plant\"\nhash = \"{}\"\n",
        onescan_server::access::TokenHash::of("y")
    );
    let today: Day = "2029-12-31".parse().expect("a day");
    Prepared::new(vec![text.into_bytes()], move |input| {
        write(&folder, TOKENS, input);
        let Ok(register) = Folder(&folder).register() else { return false };
        let shown = std::str::from_utf8(input).unwrap_or("x");
        for role in [Role::Client, Role::Operator] {
            let _ = (register.admit(Some(shown), role, today), register.admit(Some("x"), role, today));
        }
        Folder(&folder).write_register(&register).expect("what was read can be written");
        assert_eq!(Folder(&folder).register().expect("what we write ourselves"), register);
        true
    })
}

/// A certificate and its key, one behind the other.
pub(super) fn certificate(scratch: &Path) -> Prepared {
    let folder = scratch.join("certificate");
    let made =
        certificate::new(Folder(&folder), &[IpAddr::V4(Ipv4Addr::LOCALHOST)], "2029-12-31".parse().expect("a day"), 9);
    made.expect("a certificate");
    let [chain, key] = [CERTIFICATE, KEY].map(|name| std::fs::read(folder.join(name)).expect("a certificate"));
    Prepared::new(vec![[chain, key].concat()], move |input| {
        let start = b"-----BEGIN PRIVATE KEY";
        let split = input.windows(start.len()).position(|window| window == start).unwrap_or(input.len() / 2);
        write(&folder, CERTIFICATE, &input[..split]);
        write(&folder, KEY, &input[split..]);
        Folder(&folder).identity().is_ok()
    })
}

/// The subject of a client's certificate, in DER. TLS has verified it before; here nobody has.
pub(super) fn subject(_: &Path) -> Prepared {
    let tagged = |tag: u8, inner: &[u8]| [&[tag, inner.len() as u8], inner].concat();
    let part = |kind: u8, name: &str| {
        let pair = [tagged(0x06, &[0x55, 4, kind]), tagged(0x0c, name.as_bytes())].concat();
        tagged(0x31, &tagged(0x30, &pair))
    };
    let subject = tagged(0x30, &[part(3, "plant"), part(11, "viewer")].concat());
    let before = [vec![0xa0, 3, 2, 1, 2, 2, 1, 1], tagged(0x30, &[]).repeat(3)].concat();
    let seed = tagged(0x30, &tagged(0x30, &[before, subject].concat()));
    Prepared::new(vec![seed], |input| Holder::of_certificate(input).is_ok())
}

fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("a scratch folder");
    path
}
