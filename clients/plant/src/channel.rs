//! What happens to signals between the plant and the PLC: sampling, lost changes, noise, quantisation,
//! delay and jitter, scaling to raw values, inverted bits. What is real about a signal is modelled; nothing else remains.
//!
//! A signal that the plant writes passes, in this order: sample, loss, noise, quantum, delay, scale,
//! inverted bit. One that it reads passes the last two first, the other way round, and then the others. Signals without a `[[signal]]` in
//! the scene are copied. Delayed values arrive in the order in which they were sent, as on a wire.

use std::collections::VecDeque;

use onescan_server::client::ClientFault;
use onescan_server::signal::{Port, SignalType};
use serde::{Deserialize, Serialize};

use super::lateness::late_ns;
use super::model::Condition;
use super::scene::Scene;
use onescan_server::random::{Random, seed_for};

/// Bytes of the longest value that a `[[signal]]` conditions.
const LONGEST: usize = 8;

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
    outer: (usize, SignalType),
    inner: (usize, SignalType),
    memory: ChannelMemory,
}

/// What a channel remembers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ChannelMemory {
    random: Random,
    /// What it was at the last look; none before the first.
    looked: Option<f64>,
    /// The last of these that was not lost.
    held: f64,
    /// When the signal is looked at again.
    next_sample_ns: u64,
    /// What is on its way, and when it arrives.
    sent: VecDeque<(u64, f64)>,
    arrived: f64,
}

/// All signals of one direction.
pub(super) struct Channels {
    /// What is only copied: outer offset, inner offset, bytes.
    copies: Vec<(usize, usize, usize)>,
    conditioned: Vec<Channel>,
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
                        looked: None,
                        held: 0.0,
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
        Self { copies, conditioned: channels, inner: vec![0; inner] }
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
        let channels = self.conditioned.iter().map(|channel| channel.memory.clone()).collect();
        ChannelsMemory { channels, inner: self.inner.clone() }
    }

    /// True if the memory is one of such channels.
    pub(super) fn fits(&self, memory: &ChannelsMemory) -> bool {
        memory.channels.len() == self.conditioned.len() && memory.inner.len() == self.inner.len()
    }

    /// Takes a memory in that [`fits`](Self::fits).
    pub(super) fn restore(&mut self, memory: ChannelsMemory) {
        self.inner = memory.inner;
        for (channel, memory) in self.conditioned.iter_mut().zip(memory.channels) {
            channel.memory = memory;
        }
    }

    /// Takes the session's bytes in.
    ///
    /// # Errors
    /// A channel for a signal that is not a number, which no checked scene has; as in what follows.
    pub(super) fn take(&mut self, now_ns: u64, outer: &[u8]) -> Result<(), ClientFault> {
        for (from, to, size) in &self.copies {
            self.inner[*to..to + size].copy_from_slice(&outer[*from..from + size]);
        }
        for channel in &mut self.conditioned {
            let mut raw = [0; LONGEST];
            let size = channel.outer.1.size();
            raw[..size].copy_from_slice(&outer[channel.outer.0..][..size]);
            channel.flip(&mut raw[..size]);
            let raw = channel.read((0, channel.outer.1), &raw)?;
            let value = channel.pass(now_ns, channel.condition.scaled_back(raw));
            channel.write(channel.inner, &mut self.inner, value)?;
        }
        Ok(())
    }

    /// Gives the plant's bytes to the session.
    pub(super) fn give(&mut self, now_ns: u64, outer: &mut [u8]) -> Result<(), ClientFault> {
        for (to, from, size) in &self.copies {
            outer[*to..to + size].copy_from_slice(&self.inner[*from..from + size]);
        }
        for channel in &mut self.conditioned {
            let value = channel.read(channel.inner, &self.inner)?;
            let passed = channel.pass(now_ns, value);
            channel.write(channel.outer, outer, channel.condition.scaled(passed))?;
            let (at, ty) = channel.outer;
            channel.flip(&mut outer[at..at + ty.size()]);
        }
        Ok(())
    }

    /// Gives the plant's bytes at the set-up, when nothing is on its way yet: as if they had long
    /// stood so.
    pub(super) fn give_at_once(&mut self, outer: &mut [u8]) -> Result<(), ClientFault> {
        for (to, from, size) in &self.copies {
            outer[*to..to + size].copy_from_slice(&self.inner[*from..from + size]);
        }
        for channel in &mut self.conditioned {
            let value = channel.read(channel.inner, &self.inner)?;
            (channel.memory.looked, channel.memory.held) = (Some(value), value);
            channel.memory.arrived = channel.disturbed(value);
            let raw = channel.condition.scaled(channel.memory.arrived);
            channel.write(channel.outer, outer, raw)?;
        }
        Ok(())
    }
}

impl Channel {
    /// The number at a place of a port.
    fn read(&self, (at, ty): (usize, SignalType), port: &[u8]) -> Result<f64, ClientFault> {
        ty.as_f64(&port[at..]).ok_or_else(|| self.not_a_number(ty))
    }

    /// Puts a number at a place of a port.
    fn write(&self, (at, ty): (usize, SignalType), port: &mut [u8], value: f64) -> Result<(), ClientFault> {
        if write(ty, &mut port[at..], value) { Ok(()) } else { Err(self.not_a_number(ty)) }
    }

    fn not_a_number(&self, ty: SignalType) -> ClientFault {
        ClientFault::new(format!("signal `{}` is {ty}, which no `[[signal]]` can condition", self.condition.signal))
    }

    /// What is seen of a sample where changes may be lost: the last change that was not.
    fn kept(&mut self, value: f64) -> f64 {
        let Condition { lost_rate, .. } = self.condition;
        let changed = self.memory.looked.is_some_and(|looked| looked.to_bits() != value.to_bits());
        let lost = changed && lost_rate > 0.0 && self.memory.random.uniform() <= lost_rate;
        if self.memory.looked.is_none() || (changed && !lost) {
            self.memory.held = value;
        }
        self.memory.looked = Some(value);
        self.memory.held
    }

    /// Inverts a bit of the raw value, where it is this turn's turn.
    fn flip(&mut self, raw: &mut [u8]) {
        let Condition { flip_rate, .. } = self.condition;
        if flip_rate > 0.0 && self.memory.random.uniform() <= flip_rate {
            let bits = if self.outer.1 == SignalType::BOOL { 1 } else { 8 * raw.len() as u64 };
            let bit = (self.memory.random.bits() % bits) as usize;
            raw[bit / 8] ^= 1 << (bit % 8);
        }
    }

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
            if let Some(passed) = now_ns.checked_div(self.condition.sample_ns) {
                self.memory.next_sample_ns = (passed + 1) * self.condition.sample_ns;
            }
            let kept = self.kept(value);
            let sent = self.disturbed(kept);
            let late_ns = late_ns(&self.condition, &mut self.memory.random);
            let last_ns = self.memory.sent.back().map_or(0, |(at, _)| *at);
            self.memory.sent.push_back(((now_ns + late_ns).max(last_ns), sent));
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
    fn scaled(&self, value: f64) -> f64 {
        let Some(scale) = self.scale else { return value };
        let ([low, high], [raw_low, raw_high]) = (scale.range, scale.raw);
        (raw_low + (value - low) / (high - low) * (raw_high - raw_low)).clamp(raw_low, raw_high)
    }

    /// The value in the signal's unit of a raw one.
    fn scaled_back(&self, raw: f64) -> f64 {
        let Some(scale) = self.scale else { return raw };
        let ([low, high], [raw_low, raw_high]) = (scale.range, scale.raw);
        low + (raw - raw_low) / (raw_high - raw_low) * (high - low)
    }
}

/// Writes a number as a value of a type: whole numbers are rounded and limited to their range. False
/// for a type that a scene's check lets no `[[signal]]` have; nothing is written then.
#[must_use]
fn write(ty: SignalType, bytes: &mut [u8], value: f64) -> bool {
    use SignalType as T;
    let whole = value.round();
    match ty {
        T::BOOL => bytes[0] = u8::from(value != 0.0),
        T::SINT => bytes[..1].copy_from_slice(&(whole as i8).to_le_bytes()),
        T::USINT | T::BYTE => bytes[..1].copy_from_slice(&(whole as u8).to_le_bytes()),
        T::INT => bytes[..2].copy_from_slice(&(whole as i16).to_le_bytes()),
        T::UINT | T::WORD => bytes[..2].copy_from_slice(&(whole as u16).to_le_bytes()),
        T::DINT => bytes[..4].copy_from_slice(&(whole as i32).to_le_bytes()),
        T::UDINT | T::DWORD => bytes[..4].copy_from_slice(&(whole as u32).to_le_bytes()),
        T::REAL => bytes[..4].copy_from_slice(&(value as f32).to_le_bytes()),
        T::LREAL => bytes[..8].copy_from_slice(&value.to_le_bytes()),
        _ => return false,
    }
    true
}

#[cfg(test)]
mod tests {
    use onescan_server::signal::SignalName;

    use super::super::model::Range;
    use super::*;

    /// A signal to which nothing happens.
    fn plain(inner: SignalType) -> Condition {
        Condition {
            signal: SignalName::new("x").expect("a name"),
            inner,
            scale: None,
            delay_ns: 0,
            jitter_ns: 0,
            delay_sigma_ns: 0,
            sample_ns: 0,
            quantum: 0.0,
            noise_mean: 0.0,
            noise_sigma: 0.0,
            lost_rate: 0.0,
            flip_rate: 0.0,
        }
    }

    /// What arrives of a ramp of 1 in each of so many milliseconds.
    fn ramp(condition: &Condition, count: u64) -> Vec<f64> {
        let ports = [Port { name: condition.signal.clone(), ty: SignalType::LREAL }];
        let mut channels = Channels::new(&ports, std::slice::from_ref(condition), 1);
        let mut outer = [0; 8];
        (1..=count)
            .map(|k| {
                assert!(write(SignalType::LREAL, channels.inner_mut(), k as f64));
                channels.give(k * 1_000_000, &mut outer).expect("numbers");
                f64::from_le_bytes(outer)
            })
            .collect()
    }

    #[test]
    fn a_delay_is_whole_and_keeps_every_value() {
        let late = Condition { delay_ns: 3_000_000, ..plain(SignalType::LREAL) };
        assert_eq!(ramp(&late, 6), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
        assert_eq!(ramp(&plain(SignalType::LREAL), 2), [1.0, 2.0]);
    }

    #[test]
    fn samples_and_quanta_make_steps() {
        let sampled = Condition { sample_ns: 4_000_000, ..plain(SignalType::LREAL) };
        assert_eq!(ramp(&sampled, 9), [1.0, 1.0, 1.0, 4.0, 4.0, 4.0, 4.0, 8.0, 8.0]);
        let coarse = Condition { quantum: 2.5, ..plain(SignalType::LREAL) };
        assert_eq!(ramp(&coarse, 4), [0.0, 2.5, 2.5, 5.0]);
    }

    #[test]
    fn jitter_is_within_its_bound_and_never_turns_the_order() {
        let shaky = Condition { delay_ns: 2_000_000, jitter_ns: 5_000_000, ..plain(SignalType::LREAL) };
        let arrived = ramp(&shaky, 500);
        assert!(arrived.windows(2).all(|pair| pair[0] <= pair[1]));
        let ages: Vec<_> = arrived.iter().enumerate().skip(10).map(|(k, value)| (k + 1) as f64 - value).collect();
        assert!(ages.iter().all(|age| (2.0..=8.0).contains(age)), "{ages:?}");
        assert!(ages.iter().any(|age| *age > 3.0) && ages.iter().any(|age| *age < 7.0));
    }

    #[test]
    fn noise_has_its_mean_and_its_deviation() {
        let noisy = Condition { noise_mean: 3.0, noise_sigma: 0.5, ..plain(SignalType::LREAL) };
        let count = 10_000;
        let noise: Vec<_> = ramp(&noisy, count).iter().zip(1..).map(|(seen, k)| seen - f64::from(k)).collect();
        let mean = noise.iter().sum::<f64>() / count as f64;
        let variance = noise.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count as f64;
        // five standard errors: σ/√n of the mean, √(2/n) of the variance
        assert!((mean - 3.0).abs() < 0.025 && (variance / 0.25 - 1.0).abs() < 0.071, "{mean} {variance}");
    }

    /// Counts that are binomial: of 10⁶, within 5 σ.
    fn assert_is_part(count: u32, rate: f64) {
        let (n, k) = (1e6, f64::from(count));
        assert!((k - n * rate).abs() < 5.0 * (n * rate * (1.0 - rate)).sqrt(), "{k} of {n}, not {rate}");
    }

    /// What arrives of a BOOL that changes in each of 10⁶ turns.
    fn toggled(condition: &Condition) -> Vec<(bool, bool)> {
        let ports = [Port { name: condition.signal.clone(), ty: SignalType::BOOL }];
        let mut channels = Channels::new(&ports, std::slice::from_ref(condition), 5);
        let mut outer = [0];
        let mut turn = |k: u64| {
            channels.inner_mut()[0] = (k % 2) as u8;
            channels.give(k * 1_000_000, &mut outer).expect("a BOOL");
            (k % 2 == 1, outer[0] == 1)
        };
        turn(0);
        (1..=1_000_000).map(&mut turn).collect()
    }

    #[test]
    fn so_many_changes_are_lost_as_the_rate_says() {
        for rate in [0.001, 0.25] {
            let lossy = Condition { lost_rate: rate, ..plain(SignalType::LREAL) };
            let seen = ramp(&lossy, 1_000_000);
            assert_is_part(seen.iter().zip(1..).filter(|(seen, k)| **seen != f64::from(*k)).count() as u32, rate);
        }
        let never = Condition { lost_rate: 1.0, ..plain(SignalType::BOOL) };
        assert!(toggled(&never).iter().all(|(_, seen)| !seen), "the first value stands");
        assert!(toggled(&plain(SignalType::BOOL)).iter().all(|(sent, seen)| sent == seen));
    }

    #[test]
    fn a_lost_change_is_seen_with_the_next_one() {
        let lossy = Condition { lost_rate: 0.5, ..plain(SignalType::LREAL) };
        let arrived = ramp(&lossy, 200);
        assert!(arrived.iter().zip(1..).all(|(seen, k)| *seen <= f64::from(k)));
        assert!(arrived.windows(2).all(|pair| pair[0] == pair[1] || pair[1] > pair[0]));
        let behind = arrived.iter().zip(1..).filter(|(seen, k)| **seen < f64::from(*k)).count();
        assert!((60..140).contains(&behind), "{behind}");
    }

    #[test]
    fn a_bit_is_inverted_for_a_turn_as_often_as_the_rate_says() {
        let shaky = Condition { flip_rate: 0.01, ..plain(SignalType::BOOL) };
        assert_is_part(toggled(&shaky).iter().filter(|(sent, seen)| sent != seen).count() as u32, 0.01);
        let word = Condition { flip_rate: 1.0, ..plain(SignalType::WORD) };
        let ports = [Port { name: word.signal.clone(), ty: SignalType::WORD }];
        let mut channels = Channels::new(&ports, &[word], 1);
        let mut seen = [0_u32; 16];
        for k in 1..=1_600 {
            channels.take(k * 1_000_000, &0x5aa5_u16.to_le_bytes()).expect("a word");
            let changed = u16::from_le_bytes([channels.inner()[0], channels.inner()[1]]) ^ 0x5aa5;
            assert_eq!(changed.count_ones(), 1);
            seen[changed.trailing_zeros() as usize] += 1;
        }
        // 100 each, with a deviation of 9.7
        assert!(seen.iter().all(|count| (52..148).contains(count)), "{seen:?}");
    }

    #[test]
    fn raw_values_are_scaled_limited_and_scaled_back() {
        let scaled =
            Condition { scale: Some(Range { range: [0.0, 10.0], raw: [0.0, 27_648.0] }), ..plain(SignalType::LREAL) };
        assert_eq!([-1.0, 0.0, 5.0, 12.0].map(|value| scaled.scaled(value)), [0.0, 0.0, 13_824.0, 27_648.0]);
        assert_eq!(scaled.scaled_back(13_824.0), 5.0);
        let ports = [Port { name: scaled.signal.clone(), ty: SignalType::INT }];
        let mut channels = Channels::new(&ports, &[scaled], 1);
        channels.take(1_000_000, &6_912_i16.to_le_bytes()).expect("numbers");
        assert_eq!(channels.inner(), 2.5_f64.to_le_bytes());
    }

    #[test]
    fn a_saved_channel_goes_on_to_the_bit() {
        let all = Condition {
            delay_ns: 2_000_000,
            jitter_ns: 3_000_000,
            delay_sigma_ns: 1_000_000,
            lost_rate: 0.3,
            noise_sigma: 1.0,
            sample_ns: 2_000_000,
            ..plain(SignalType::LREAL)
        };
        let ports = [Port { name: all.signal.clone(), ty: SignalType::LREAL }];
        let new = |seed: u64| Channels::new(&ports, std::slice::from_ref(&all), seed);
        let (mut first, mut second, mut outer) = (new(1), new(2), [[0; 8]; 2]);
        for k in 1..200 {
            assert!(write(SignalType::LREAL, first.inner_mut(), k as f64));
            first.give(k * 1_000_000, &mut outer[0]).expect("numbers");
            if k > 100 {
                assert!(write(SignalType::LREAL, second.inner_mut(), k as f64));
                second.give(k * 1_000_000, &mut outer[1]).expect("numbers");
                assert_eq!(outer[0], outer[1], "{k}");
            } else if k == 100 {
                assert!(second.fits(&first.memory()));
                second.restore(first.memory());
            }
        }
        assert_eq!(first.memory(), second.memory());
    }
}
