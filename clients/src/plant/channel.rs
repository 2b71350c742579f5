//! What happens to signals between the plant and the PLC: sampling, noise, quantisation, delay and
//! jitter, scaling to raw values. What is real about a signal is modelled; nothing else remains.
//!
//! A signal that the plant writes passes, in this order: sample, noise, quantum, delay, scale. One
//! that it reads is scaled back first, and then passes the same. Signals without a `[[signal]]` in
//! the scene are copied. Delayed values arrive in the order in which they were sent, as on a wire.

use std::collections::VecDeque;

use onescan_server::signal::{ElementaryType, Port};
use serde::{Deserialize, Serialize};

use super::random::{Random, seed_for};
use super::scene::Scene;
use super::scene::model::Condition;

/// The ports as the plant's inside has them.
pub(super) fn inner_ports(outer: &[Port], conditions: &[Condition]) -> Vec<Port> {
    let inner = |port: &Port| {
        let condition = conditions.iter().find(|condition| condition.signal == port.name);
        Port { name: port.name.clone(), ty: condition.map_or(port.ty, |condition| condition.inner) }
    };
    outer.iter().map(inner).collect()
}

/// One signal on its way.
struct Channel {
    condition: Condition,
    outer: (usize, ElementaryType),
    inner: (usize, ElementaryType),
    memory: ChannelMemory,
}

/// What a channel remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ChannelMemory {
    random: Random,
    /// When the signal is looked at again.
    next_sample_ns: u64,
    /// What is on its way, and when it arrives.
    sent: VecDeque<(u64, f64)>,
    /// What arrived last.
    arrived: f64,
}

/// All signals of one direction.
pub(super) struct Channels {
    /// What is only copied: outer offset, inner offset, bytes.
    copies: Vec<(usize, usize, usize)>,
    channels: Vec<Channel>,
    inner: Vec<u8>,
}

/// What the channels of one direction remember.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ChannelsMemory {
    channels: Vec<ChannelMemory>,
    inner: Vec<u8>,
}

impl Channels {
    /// The channels of what a scene reads, and of what it writes.
    pub(super) fn pair(scene: &Scene, seed: u64) -> [Self; 2] {
        [&scene.reads, &scene.writes].map(|ports| Self::new(ports, &scene.conditions, seed))
    }

    fn new(ports: &[Port], conditions: &[Condition], seed: u64) -> Self {
        let (mut copies, mut channels) = (Vec::new(), Vec::new());
        let (mut outer, mut inner) = (0, 0);
        for port in ports {
            match conditions.iter().find(|condition| condition.signal == port.name) {
                None => copies.push((outer, inner, port.ty.size())),
                Some(condition) => channels.push(Channel {
                    outer: (outer, port.ty),
                    inner: (inner, condition.inner),
                    memory: ChannelMemory {
                        random: Random::new(seed_for(seed, "signal", port.name.as_str())),
                        next_sample_ns: 0,
                        sent: VecDeque::new(),
                        arrived: 0.0,
                    },
                    condition: condition.clone(),
                }),
            }
            outer += port.ty.size();
            inner +=
                inner_ports(std::slice::from_ref(port), conditions).iter().map(|port| port.ty.size()).sum::<usize>();
        }
        Self { copies, channels, inner: vec![0; inner] }
    }

    /// The bytes inside.
    pub(super) fn inner(&self) -> &[u8] {
        &self.inner
    }

    /// The bytes inside, to be written.
    pub(super) fn inner_mut(&mut self) -> &mut [u8] {
        &mut self.inner
    }

    pub(super) fn memory(&self) -> ChannelsMemory {
        let channels = self.channels.iter().map(|channel| channel.memory.clone()).collect();
        ChannelsMemory { channels, inner: self.inner.clone() }
    }

    /// True if the memory is one of such channels, which then have it.
    pub(super) fn restore(&mut self, memory: ChannelsMemory) -> bool {
        let fits = memory.channels.len() == self.channels.len() && memory.inner.len() == self.inner.len();
        if fits {
            self.inner = memory.inner;
            for (channel, memory) in self.channels.iter_mut().zip(memory.channels) {
                channel.memory = memory;
            }
        }
        fits
    }

    /// Takes the session's bytes in.
    pub(super) fn take(&mut self, now_ns: u64, outer: &[u8]) {
        for (from, to, size) in &self.copies {
            self.inner[*to..to + size].copy_from_slice(&outer[*from..from + size]);
        }
        for channel in &mut self.channels {
            let raw = channel.outer.1.as_f64(&outer[channel.outer.0..]).unwrap_or_default();
            let value = channel.pass(now_ns, channel.condition.from_raw(raw));
            write(channel.inner.1, &mut self.inner[channel.inner.0..], value);
        }
    }

    /// Gives the plant's bytes to the session.
    pub(super) fn give(&mut self, now_ns: u64, outer: &mut [u8]) {
        for (to, from, size) in &self.copies {
            outer[*to..to + size].copy_from_slice(&self.inner[*from..from + size]);
        }
        for channel in &mut self.channels {
            let value = channel.inner.1.as_f64(&self.inner[channel.inner.0..]).unwrap_or_default();
            let passed = channel.pass(now_ns, value);
            write(channel.outer.1, &mut outer[channel.outer.0..], channel.condition.to_raw(passed));
        }
    }

    /// Gives the plant's bytes at the set-up, when nothing is on its way yet: as if they had long
    /// stood so.
    pub(super) fn give_at_once(&mut self, outer: &mut [u8]) {
        for (to, from, size) in &self.copies {
            outer[*to..to + size].copy_from_slice(&self.inner[*from..from + size]);
        }
        for channel in &mut self.channels {
            let value = channel.inner.1.as_f64(&self.inner[channel.inner.0..]).unwrap_or_default();
            channel.memory.arrived = channel.disturbed(value);
            let raw = channel.condition.to_raw(channel.memory.arrived);
            write(channel.outer.1, &mut outer[channel.outer.0..], raw);
        }
    }
}

impl Channel {
    /// A sample with its noise, rounded to the quantum.
    fn disturbed(&mut self, value: f64) -> f64 {
        let Condition { quantum, noise_mean, noise_sigma, .. } = self.condition;
        let noise = if noise_sigma > 0.0 { noise_mean + noise_sigma * self.memory.random.normal() } else { noise_mean };
        let noisy = value + noise;
        if quantum > 0.0 { (noisy / quantum).round() * quantum } else { noisy }
    }

    /// What arrives now, where `value` is sent now.
    fn pass(&mut self, now_ns: u64, value: f64) -> f64 {
        if now_ns >= self.memory.next_sample_ns {
            let sample_ns = self.condition.sample_ns;
            if sample_ns > 0 {
                self.memory.next_sample_ns = (now_ns / sample_ns + 1) * sample_ns;
            }
            let sent = self.disturbed(value);
            let late_ns = match self.condition.jitter_ns {
                0 => 0,
                jitter_ns => (jitter_ns as f64 * self.memory.random.uniform()) as u64,
            };
            let last_ns = self.memory.sent.back().map_or(0, |(at, _)| *at);
            self.memory.sent.push_back(((now_ns + self.condition.delay_ns + late_ns).max(last_ns), sent));
        }
        while let Some((at, value)) = self.memory.sent.front().copied()
            && at <= now_ns
        {
            self.memory.arrived = value;
            self.memory.sent.pop_front();
        }
        self.memory.arrived
    }
}

impl Condition {
    /// The raw value of a value in the signal's unit; limited to the raw range.
    fn to_raw(&self, value: f64) -> f64 {
        let Some(scale) = self.scale else { return value };
        let ([low, high], [raw_low, raw_high]) = (scale.range, scale.raw);
        (raw_low + (value - low) / (high - low) * (raw_high - raw_low)).clamp(raw_low, raw_high)
    }

    /// The value in the signal's unit of a raw one.
    fn from_raw(&self, raw: f64) -> f64 {
        let Some(scale) = self.scale else { return raw };
        let ([low, high], [raw_low, raw_high]) = (scale.range, scale.raw);
        low + (raw - raw_low) / (raw_high - raw_low) * (high - low)
    }
}

/// Writes a number as a value of a type: whole numbers are rounded and limited to their range.
fn write(ty: ElementaryType, bytes: &mut [u8], value: f64) {
    use ElementaryType as T;
    let whole = value.round();
    match ty {
        T::Bool => bytes[0] = u8::from(value != 0.0),
        T::Sint => bytes[..1].copy_from_slice(&(whole as i8).to_le_bytes()),
        T::Usint | T::Byte => bytes[..1].copy_from_slice(&(whole as u8).to_le_bytes()),
        T::Int => bytes[..2].copy_from_slice(&(whole as i16).to_le_bytes()),
        T::Uint | T::Word => bytes[..2].copy_from_slice(&(whole as u16).to_le_bytes()),
        T::Dint => bytes[..4].copy_from_slice(&(whole as i32).to_le_bytes()),
        T::Udint | T::Dword => bytes[..4].copy_from_slice(&(whole as u32).to_le_bytes()),
        T::Real => bytes[..4].copy_from_slice(&(value as f32).to_le_bytes()),
        // the scene's check lets no other type through
        _ => bytes[..8].copy_from_slice(&value.to_le_bytes()),
    }
}
