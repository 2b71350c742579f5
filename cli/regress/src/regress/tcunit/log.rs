//! Messages of `ADSLOGSTR`, which the library here keeps: the last 32 of them (`iec/vendor/tc2_system.st`).

use onescan_iec_run::{Application, Variable};

use super::super::memory_text;
use super::memory::number;

/// The kind of message that is an error: `ADSLOG_MSGTYPE_ERROR`.
const ERROR: u64 = 4;

/// A message that is an error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) text: String,
    /// Virtual time of the scan that sent it.
    pub(super) at_ns: u64,
}

/// Where messages are kept, and those that were taken from there.
pub(super) struct Log {
    places: Option<Places>,
    seen: u64,
    messages: Vec<Message>,
}

struct Places {
    count: Variable,
    /// Kind and text of each.
    ring: Vec<(Variable, Variable)>,
}

impl Log {
    pub(super) fn find(application: &Application) -> Self {
        let found = |member: &str| application.variable(&format!("Tc2_System.OnescanAdsLog.{member}")).ok();
        let entries = (0_u32..).map_while(|at| found(&format!("masks[{at}]")).zip(found(&format!("texts[{at}]"))));
        let places = found("count").map(|count| Places { count, ring: entries.collect() });
        Self { places: places.filter(|places| !places.ring.is_empty()), seen: 0, messages: Vec::new() }
    }

    /// Takes what was sent since the last time.
    pub(super) fn take(&mut self, memory: &[u8], at_ns: u64) {
        let Some(Places { count, ring }) = &self.places else { return };
        let Some(sent) = memory_text::bytes(count, memory).map(number) else { return };
        let size = ring.len() as u64;
        let lost = sent.saturating_sub(self.seen).saturating_sub(size);
        if lost > 0 {
            let text = format!("{lost} messages were sent and not kept: only the last {size} of a scan are");
            self.messages.push(Message { text, at_ns });
        }
        for entry in self.seen + lost..sent {
            let Some((kind, line)) = ring.get((entry % size) as usize) else { continue };
            if memory_text::bytes(kind, memory).is_some_and(|kind| number(kind) & ERROR != 0) {
                self.messages.extend(memory_text::text(line, memory).map(|text| Message { text, at_ns }));
            }
        }
        self.seen = sent;
    }

    pub(super) fn messages(self) -> Vec<Message> {
        self.messages
    }
}
