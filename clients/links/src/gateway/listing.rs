//! All points of a link with their places, in the order in which they lie: what a PLC is to have.

use super::ads;
use super::exchange::{Direction, Exchange, Point};
use super::modbus::RegisterMap;
use super::settings::{Settings, SettingsFault};
use super::tcp::Layouts;

/// What a link carries.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    /// What the gateway writes.
    pub to_plc: Part,
    pub from_plc: Part,
}

/// What goes one way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Where all of it is, as in `DB1, 38 bytes`, if the link has such a thing.
    pub place: Option<String>,
    /// The points in the order in which they lie.
    pub rows: Vec<Row>,
}

/// A point with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    pub point: Point,
    /// Its address, as a map writes it.
    pub address: String,
}

impl Listing {
    /// The points of `exchange` over the link of `settings`.
    ///
    /// # Errors
    /// The URL names no link, or a point has no place on it.
    pub fn new(settings: &Settings, exchange: &Exchange) -> Result<Self, SettingsFault> {
        let scheme = settings.scheme()?.0;
        if scheme == "modbus" {
            let map = RegisterMap::new(&settings.modbus, exchange)?;
            let key = |entry: &super::modbus::map::Entry| (entry.address.table, entry.address.at, entry.address.bit);
            let keys = [&map.to_plc, &map.from_plc].map(|entries| entries.iter().map(key).collect());
            return Ok(Self::sorted(exchange, map.places(), keys, [None, None]));
        }
        if matches!(scheme, "tcp" | "tcp-listen" | "s7") {
            let layouts = Layouts::new(&settings.layout, exchange)?;
            let sizes = [layouts.to_plc.size(), layouts.from_plc.size()];
            let place = |db: u16, size: usize| {
                Some(if scheme == "s7" { format!("DB{db}, {size} bytes") } else { format!("{size} bytes") })
            };
            let shown = [place(settings.s7.db_to_plc, sizes[0]), place(settings.s7.db_from_plc, sizes[1])];
            return Ok(Self::sorted(exchange, layouts.places(), layouts.keys(), shown));
        }
        let symbol = |point: &Point| match (&point.address, scheme) {
            (Some(address), _) => address.clone(),
            (None, "ads") => ads::Options::symbol(&settings.ads, point),
            (None, _) => format!("nsu={};s={}", settings.opcua.namespace, point.symbol()),
        };
        let part = |direction| {
            let row = |point: &Point| Row { point: point.clone(), address: symbol(point) };
            Part { place: None, rows: exchange.points(direction).iter().map(row).collect() }
        };
        Ok(Self { to_plc: part(Direction::ToPlc), from_plc: part(Direction::FromPlc) })
    }

    /// The points by their places.
    fn sorted<Key: Ord>(
        exchange: &Exchange,
        addresses: [Vec<String>; 2],
        keys: [Vec<Key>; 2],
        places: [Option<String>; 2],
    ) -> Self {
        let part = |direction, addresses: Vec<String>, keys: Vec<Key>, place| {
            let points = exchange.points(direction).iter().cloned();
            let row = |(point, address)| Row { point, address };
            let mut rows: Vec<(Key, Row)> = keys.into_iter().zip(points.zip(addresses).map(row)).collect();
            rows.sort_by(|(one, _), (other, _)| one.cmp(other));
            Part { place, rows: rows.into_iter().map(|(_, row)| row).collect() }
        };
        let ([to, from], [to_keys, from_keys], [to_place, from_place]) = (addresses, keys, places);
        Self {
            to_plc: part(Direction::ToPlc, to, to_keys, to_place),
            from_plc: part(Direction::FromPlc, from, from_keys, from_place),
        }
    }
}
