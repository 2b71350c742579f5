//! What a scenario says of a link, and the link made of it.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::time::Duration;

use onescan_base::did_you_mean;
use onescan_server::time::TimeSpan;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use thiserror::Error;

use super::addresses::Addresses;
use super::ads::{self, AdsLink};
use super::client::Patience;
use super::exchange::{Direction, Exchange, Words};
use super::fault::{LinkFault, MappingFault};
use super::link::{Found, Link};
use super::modbus::{self, ModbusLink};
use super::opcua::links;
use super::s7::{self, S7Link};
use super::socket::REQUEST_TIMEOUT;
use super::tcp::{Declaration, Layouts, TcpLink};
use crate::opcua::Options;

/// A PLC's link as a scenario declares it, `[clients.NAME.gateway]`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Where the PLC is, as in `tcp://192.168.0.1:2000`.
    pub url: String,
    /// How a step of the session and a cycle of the PLC are brought together.
    pub handshake: HandshakeKind,
    /// Blocks of the PLC that make up a step, with `handshake = "frames"`.
    pub frames_per_step: Option<NonZeroU32>,
    /// True if the PLC serves `PLC_Start`, `PLC_Boots` and `PLC_Running`. A PLC is taken for one that does not unless it is said;
    /// `onescan plc` starts itself then, and not where it is said that nobody does.
    pub system_words: Option<bool>,
    /// How long a grant may stay unanswered.
    pub grant_timeout: Option<Text<TimeSpan>>,
    /// How long a lost connection may stay lost.
    pub reconnect_timeout: Option<Text<TimeSpan>>,
    /// How long a PLC that must be started cold is waited for.
    pub start_timeout: Option<Text<TimeSpan>>,
    /// How long a connection may take to come about, and the PLC to answer a request.
    pub request_timeout: Option<Text<TimeSpan>>,
    /// Addresses of signals and words that do not lie where the link looks for them: one; or, for a signal that several
    /// variables read, a list in the order of their paths, or a table by path.
    pub map: BTreeMap<String, Addresses>,
    /// Blocks of a raw TCP or an S7 link.
    pub layout: Declaration,
    /// CPU and block numbers of an S7 link.
    pub s7: s7::Options,
    /// Registers of a Modbus link.
    pub modbus: modbus::Options,
    /// AMS addresses of an ADS link.
    pub ads: ads::Options,
    /// Security and namespace of an OPC UA link.
    pub opcua: Options,
}

impl Settings {
    /// The files and folders that it names.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        [&self.opcua.user_certificate, &self.opcua.user_key, &self.opcua.pki]
            .into_iter()
            .flatten()
            .map(PathBuf::as_path)
    }
}

/// How a step of the session and a cycle of the PLC are brought together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HandshakeKind {
    /// By the words of the instrumented program: lockstep.
    #[default]
    Words,
    /// By counting blocks, for a PLC whose program cannot be instrumented: no lockstep.
    Frames,
}

/// A value written as text with a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text<T>(pub T);

impl<'de, T> Deserialize<'de> for Text<T>
where
    T: std::str::FromStr,
    T::Err: std::fmt::Display,
{
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer)?.parse().map(Self).map_err(serde::de::Error::custom)
    }
}

impl JsonSchema for Text<TimeSpan> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Time".into()
    }

    /// A number and a unit. What the pattern cannot exclude, such as fractions of a nanosecond, the reader refuses.
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "pattern": r"^ *[0-9][0-9_]*(\.[0-9_]+)? *(ns|us|ms|s|min|h) *$" })
    }
}

/// A URL that names no link.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{url}` is not the address of a PLC: {reason}")]
pub struct BadUrl {
    /// What was written.
    pub url: String,
    /// What is wrong with it.
    pub reason: String,
    /// What to do.
    pub help: Option<String>,
}

/// The links there are, by the scheme of their URL.
const SCHEMES: [&str; 6] = ["tcp", "tcp-listen", "modbus", "opc.tcp", "s7", "ads"];

/// Why there is no link.
#[derive(Clone, Debug, Error)]
pub enum SettingsFault {
    /// The URL is wrong.
    #[error(transparent)]
    Url(#[from] BadUrl),
    /// A point has no place on this link.
    #[error(transparent)]
    Mapping(#[from] MappingFault),
    /// The link cannot be made.
    #[error(transparent)]
    Link(#[from] LinkFault),
}

impl Settings {
    /// The words that the PLC and the gateway exchange.
    pub fn words(&self) -> Words {
        match (self.handshake, self.system_words) {
            (HandshakeKind::Frames, _) => Words::Absent,
            (HandshakeKind::Words, Some(true)) => Words::WithSystem,
            (HandshakeKind::Words, Some(false) | None) => Words::Handshake,
        }
    }

    /// The address at which the gateway listens, if the PLC is the one that connects.
    ///
    /// # Errors
    /// The URL names no link, or no address of this machine.
    pub fn listens_on(&self) -> Result<Option<SocketAddr>, BadUrl> {
        let ("tcp-listen", address) = self.scheme()? else { return Ok(None) };
        address.parse().map(Some).map_err(|_| BadUrl {
            url: self.url.clone(),
            reason: "it has no IP address and port".to_owned(),
            help: Some("write it as in `tcp-listen://127.0.0.1:2000`".to_owned()),
        })
    }

    /// How long the gateway waits.
    pub fn patience(&self) -> Patience {
        let or = |text: Option<Text<TimeSpan>>, default| {
            text.map_or(default, |text| Duration::from_nanos(text.0.as_nanos()))
        };
        let default = Patience::default();
        Patience {
            grant: or(self.grant_timeout, default.grant),
            reconnect: or(self.reconnect_timeout, default.reconnect),
            start: or(self.start_timeout, default.start),
        }
    }

    /// How long a request waits.
    fn timeout(&self) -> Duration {
        self.request_timeout.map_or(REQUEST_TIMEOUT, |text| Duration::from_nanos(text.0.as_nanos()))
    }

    /// Scheme and rest of the URL.
    ///
    /// # Errors
    /// A URL without one, or with one that no link has.
    pub fn scheme(&self) -> Result<(&str, &str), BadUrl> {
        let bad = |reason: &str, help| BadUrl { url: self.url.clone(), reason: reason.to_owned(), help };
        let (scheme, rest) = self
            .url
            .split_once("://")
            .ok_or_else(|| bad("it has no scheme", Some("write it as in `tcp://192.168.0.1:2000`".to_owned())))?;
        if SCHEMES.contains(&scheme) {
            return Ok((scheme, rest.trim_end_matches('/')));
        }
        let known = SCHEMES.join("`, `");
        let help = did_you_mean(scheme, SCHEMES).unwrap_or_else(|| format!("known are `{known}`"));
        Err(bad("no link has this scheme", Some(help)))
    }

    /// The link for the points of `exchange`, not connected yet.
    ///
    /// # Errors
    /// See [`SettingsFault`].
    pub fn link(&self, exchange: &Exchange) -> Result<Box<dyn Link>, SettingsFault> {
        let ((scheme, address), timeout) = (self.scheme()?, self.timeout());
        if let (HandshakeKind::Words, Some(_)) = (self.handshake, self.frames_per_step) {
            let text = "`frames_per_step` needs `handshake = \"frames\"`";
            return Err(LinkFault::Setting(text.to_owned()).into());
        }
        Ok(match scheme {
            "modbus" => Box::new(ModbusLink::new(address, self.modbus, exchange, timeout)?),
            "opc.tcp" => links()?.link(&self.url, &self.opcua, exchange, timeout)?,
            "ads" => Box::new(AdsLink::new(address, self.ads.clone(), exchange, timeout)),
            "s7" => Box::new(S7Link::new(address, self.s7, exchange, Layouts::new(&self.layout, exchange)?, timeout)?),
            _ if self.handshake == HandshakeKind::Words => Box::new(self.blocks(exchange)?.expecting_blocks()),
            _ => Box::new(self.blocks(exchange)?),
        })
    }

    /// Data blocks over TCP, whoever connects.
    fn blocks(&self, exchange: &Exchange) -> Result<TcpLink, SettingsFault> {
        let (layouts, timeout) = (Layouts::new(&self.layout, exchange)?, self.timeout());
        Ok(match self.listens_on()? {
            Some(address) => TcpLink::listening(address, layouts, timeout),
            None => TcpLink::new(self.scheme()?.1, layouts, timeout),
        })
    }

    /// The link for a PLC whose blocks are counted, and how many of them make up a step; nothing for one that is driven by
    /// words.
    ///
    /// # Errors
    /// A link without blocks, or a key that has no meaning here. See [`SettingsFault`].
    pub fn counted(&self, exchange: &Exchange) -> Result<Option<(TcpLink, NonZeroU32)>, SettingsFault> {
        if self.handshake == HandshakeKind::Words {
            return Ok(None);
        }
        let wrong = |text: &str| Err(LinkFault::Setting(format!("`handshake = \"frames\"` {text}")).into());
        let scheme = self.scheme()?.0;
        if !matches!(scheme, "tcp" | "tcp-listen") {
            return wrong(&format!("counts blocks, and {scheme} has none: use `tcp` or `tcp-listen`"));
        }
        if self.system_words == Some(true) {
            return wrong("exchanges no words: leave out `system_words`");
        }
        if exchange.size(Direction::FromPlc) == 0 || exchange.size(Direction::ToPlc) == 0 {
            return wrong("counts blocks: the PLC must read a signal and write one");
        }
        Ok(Some((self.blocks(exchange)?, self.frames_per_step.unwrap_or(NonZeroU32::MIN))))
    }

    /// Everything that the PLC says it has.
    ///
    /// # Errors
    /// A protocol without names, or the PLC cannot be reached.
    pub fn browse(&self) -> Result<Vec<Found>, SettingsFault> {
        let nothing = Exchange::new(&[], &[], Words::Handshake, &BTreeMap::new());
        match self.scheme()?.0 {
            "opc.tcp" => Ok(links()?.browse(&self.url, &self.opcua, self.timeout())?),
            "ads" => Ok(AdsLink::new(self.scheme()?.1, self.ads.clone(), &nothing, self.timeout()).browse()?),
            scheme => {
                let text = format!("nothing can be browsed over {scheme}: its values have addresses and no names");
                Err(LinkFault::Setting(text).into())
            }
        }
    }
}
