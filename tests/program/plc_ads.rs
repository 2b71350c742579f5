//! A PLC over ADS: seen by a client that others have made, and devices that are not what they should be.

use std::io::{Read, Write};
use std::net::TcpListener;

use ads::{AdsState, AmsAddr, AmsNetId, Client, Handle, Source, Timeouts, symbol};

use crate::plc::Plc;
use crate::typed::{Said, copied_shear, edit, scenario, typed};

/// Another's client at the PLC's address.
fn client(plc: &Plc) -> Client {
    let address = plc.gateway("ads://").replace("plc=ads://", "");
    let source = Source::Addr(AmsAddr::new(AmsNetId::new(127, 0, 0, 1, 1, 1), 40_001));
    Client::new(address.as_str(), Timeouts::new(std::time::Duration::from_secs(10)), source).expect("it listens")
}

#[test]
fn the_ads_crate_sees_a_device() {
    let plc = Plc::start(&scenario("shear"), &["--ads", "127.0.0.1:0"]);
    let client = client(&plc);
    let device = client.device(AmsAddr::new(AmsNetId::new(127, 0, 0, 1, 1, 1), 851));
    assert_eq!(device.get_info().unwrap().name, "onescan plc");
    assert_eq!(device.get_state().unwrap().0, AdsState::Run);
    let (symbols, types) = symbol::get_symbol_info(device).unwrap();
    let reported = |symbol: &symbol::Symbol| format!("{}: {}, {} bytes", symbol.name, symbol.typ, symbol.size);
    insta::assert_snapshot!(symbols.iter().map(reported).collect::<Vec<_>>().join("\n"));
    assert!(types.is_empty(), "all of them are elementary");

    let position = Handle::new(device, "Shear.Position_1").unwrap();
    position.write_value(&-0.125_f64).unwrap();
    assert_eq!(position.read_value::<f64>().unwrap().to_bits(), (-0.125_f64).to_bits());
    let strokes = Handle::new(device, "shear.strokes").expect("names are found in any case");
    assert_eq!(strokes.read_value::<i32>().unwrap(), 0);
    let refused = [
        strokes.write_value(&1_i32).unwrap_err().to_string(),
        position.write_value(&1_u8).unwrap_err().to_string(),
        Handle::new(device, "Shear.Strokse").map(|handle| handle.raw()).unwrap_err().to_string(),
        device.read(0x4021, 0, &mut [0; 4]).unwrap_err().to_string(),
        device.write(0x4040, 0xFFFF, &[0]).unwrap_err().to_string(),
        device.get_info().and_then(|_| device.write_control(AdsState::Config, 0)).unwrap_err().to_string(),
    ];
    insta::assert_snapshot!(refused.join("\n"));

    device.write_control(AdsState::Stop, 0).unwrap();
    assert_eq!(device.get_state().unwrap().0, AdsState::Stop);
    device.write_control(AdsState::Run, 0).unwrap();
    assert_eq!(device.get_state().unwrap().0, AdsState::Run);
}

#[test]
fn symbols_are_listed_and_mapped() {
    let folder = copied_shear();
    let plc = Plc::start(folder.path(), &["--ads", "127.0.0.1:0"]);
    let url = plc.gateway("ads://").replace("plc=", "");
    let said = typed(folder.path(), &["browse", &url, "--scenario", ".", "--map", "map.toml"]);
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(said.out.contains("SDSP.SDSP_Grant"), "{said:?}");
    let map = std::fs::read_to_string(folder.path().join("map.toml")).unwrap();
    insta::assert_snapshot!(map.replace(&url, "ads://HOST:PORT"));
}

/// A run of the shear against `url`, with what the scenario says besides.
fn run_against(url: &str, settings: &str) -> Said {
    let folder = copied_shear();
    edit(folder.path(), "scenario.toml", "system_words = true", &format!("system_words = true\n{settings}"));
    typed(folder.path(), &["run", ".", "--until", "1s", "--gateway", url])
}

#[test]
fn what_does_not_fit_is_reported_at_connect() {
    let plc = Plc::start(&scenario("shear"), &["--ads", "127.0.0.1:0"]);
    let wrong = [
        "map = { Strokes = \"Shear.Strokse\" }",
        "map = { Strokes = \"Shear.Position_1\" }",
        "map = { Sensor_1 = [\"Alignment.Aligned\", \"Shear.Sensor_1\"] }",
        "ads = { words = \"GVL\" }",
        "ads = { net_id = \"1.2.3\" }",
    ];
    let reported = wrong.map(|settings| {
        let said = run_against(&plc.gateway("ads://"), settings);
        assert_eq!(said.code, Some(2), "{settings}: {said:?}");
        said.err
    });
    insta::assert_snapshot!(reported.join("----\n"));
}

/// A device that answers each connection's first request with `answer`, and then closes.
fn device(answer: Vec<u8>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        while let Ok((mut stream, _)) = listener.accept() {
            let _ = stream.read(&mut [0; 4096]);
            // The other side may not wait for it.
            let _ = stream.write_all(&answer);
        }
    });
    format!("plc=ads://{address}")
}

#[test]
fn devices_that_are_none_are_distinguished() {
    let frame = |length: u32, rest: &[u8]| [&[0, 0][..], &length.to_le_bytes(), rest].concat();
    let answers = [
        ("closed without an answer", Vec::new(), "has the PLC a route to 127.0.0.1.1.1?"),
        ("4 GiB announced", frame(u32::MAX, &[]), "a frame of 4294967295 bytes"),
        ("a short frame", frame(8, &[0; 8]), "a frame of 8 bytes"),
        ("no ADS command", vec![1, 16, 0, 0, 0, 0], "not an ADS command"),
        ("lengths that contradict", frame(32, &[255; 32]), "state flags"),
    ];
    for (what, answer, text) in answers {
        let said = run_against(&device(answer), "reconnect_timeout = \"300ms\"");
        assert_eq!(said.code, Some(3), "{what}: {said:?}");
        let joined: String = said.err.split_whitespace().collect::<Vec<_>>().join(" ").replace("│ ", "");
        assert!(joined.contains(text), "{what}: {joined}");
    }
}
