use std::collections::BTreeMap;

use onescan_server::signal::{Port, SignalName};
use proptest::prelude::*;

use super::*;
use crate::gateway::exchange::{Feed, Words};
use crate::gateway::modbus::registers;

const TYPES: [SignalType; 7] = [
    SignalType::BOOL,
    SignalType::BYTE,
    SignalType::INT,
    SignalType::DINT,
    SignalType::REAL,
    SignalType::LREAL,
    SignalType::BOOL,
];

fn exchange(ports: &[(&str, SignalType)], addresses: &[(&str, &str)]) -> Exchange {
    let addresses: BTreeMap<&str, &str> = addresses.iter().copied().collect();
    let feed = |(name, ty): &(&str, SignalType)| {
        let port = Port { name: SignalName::new(*name).unwrap(), ty: *ty };
        Feed::whole(&port, addresses.get(name).map(|address| (*address).to_owned()))
    };
    let inputs: Vec<Feed> = ports.iter().map(feed).collect();
    Exchange::new(&inputs, &[], Words::Handshake, &BTreeMap::new())
}

#[test]
fn what_is_wrong_with_a_map_is_reported() {
    use SignalType as T;
    let reported = |ty, address: &str| {
        let exchange = exchange(&[("a", ty), ("b", ty)], &[("a", address), ("b", "hr:50")]);
        RegisterMap::new(&Options::default(), &exchange).map_or_else(|f| f.to_string(), |_| "fine".to_owned())
    };
    let all = [
        reported(T::REAL, "hr:100"),
        reported(T::REAL, "hr:49"),
        reported(T::REAL, "coil:1"),
        reported(T::REAL, "hr:1.3"),
        reported(T::REAL, "ir:1"),
        reported(T::REAL, "hr:65535"),
        reported(T::REAL, "4x100"),
        reported(T::BOOL, "hr:8.3"),
        reported(T::BOOL, "hr:8.16"),
        reported(T::String(4), "hr:20"),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn neighbours_share_a_request_and_the_grant_is_in_the_last() {
    let named: Vec<String> = (0..100).map(|i| format!("s{i}")).collect();
    let ports: Vec<_> = named.iter().map(|name| (name.as_str(), SignalType::REAL)).collect();
    let map = RegisterMap::new(&Options::default(), &exchange(&ports, &[("s3", "coil:9")])).unwrap_err();
    assert!(map.to_string().contains("does not fit into the bit coil:9"));
    let map = RegisterMap::new(&Options::default(), &exchange(&ports, &[("s3", "hr:5000")])).unwrap();
    let writes = map.writes();
    let span = |at, count| Span { table: Table::HoldingRegister, at, count };
    // The others stay where they are without it.
    assert_eq!(writes, [span(0, 6), span(5000, 2), span(8, 122), span(130, 80)]);
    let grant = map.to_plc.last().unwrap();
    assert_eq!((grant.point.name.as_str(), grant.end()), ("SDSP_Grant", 210));
    assert_eq!(map.reads(), [span(1000, 7)]);
}

proptest! {
    #[test]
    fn values_come_back(types in prop::collection::vec(0..7_usize, 1..30), is_little in any::<bool>(), seed in any::<u64>()) {
        let named: Vec<String> = (0..types.len()).map(|i| format!("s{i}")).collect();
        let ports: Vec<_> = named.iter().zip(&types).map(|(name, ty)| (name.as_str(), TYPES[*ty])).collect();
        let exchange = exchange(&ports, &[]);
        let word_order = if is_little { ByteOrder::LittleEndian } else { ByteOrder::BigEndian };
        let map = RegisterMap::new(&Options { word_order, ..Options::default() }, &exchange).unwrap();
        let mut state = seed;
        let mut packed = Vec::new();
        for point in exchange.to_plc() {
            for _ in 0..point.ty.size() {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                packed.push(if point.ty == SignalType::BOOL { (state >> 60) as u8 & 1 } else { (state >> 33) as u8 });
            }
        }
        let mut back = vec![0; packed.len()];
        for span in map.writes() {
            let mut words = vec![0xffff; usize::from(span.count)];
            map.to_plc.iter().for_each(|entry| registers::put(entry, &packed, map.word_order, &span, &mut words));
            map.to_plc.iter().for_each(|entry| registers::take(entry, &words, map.word_order, &span, &mut back));
        }
        prop_assert_eq!(back, packed);
    }
}
