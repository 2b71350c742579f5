//! The first contact with a PLC: as patient as any later one. A PLC that is still starting is not a reason to end.

use onescan_base::notice::NOTICE;
use std::time::{Duration, Instant};

use super::fault::LinkFault;
use super::link::Link;

/// A connection is tried again after this.
const AGAIN: Duration = Duration::from_millis(200);

/// Connects `link` for the client `name`, again and again for as long as `patience`. What another attempt cannot solve is
/// said at once.
///
/// # Errors
/// See [`LinkFault`]; one that may be mended says how often and for how long it was tried.
pub(super) fn connect(link: &mut dyn Link, name: &str, patience: Duration) -> Result<(), LinkFault> {
    let begun = Instant::now();
    let mut tried = 0;
    loop {
        tried += 1;
        let fault = match link.connect() {
            Ok(()) => return Ok(()),
            Err(fault) if !fault.is_transient() => return Err(fault),
            Err(fault) => fault,
        };
        if begun.elapsed() >= patience {
            return Err(fault.tried(tried, patience));
        }
        if tried == 1 {
            match fault {
                LinkFault::NobodyCame { url, .. } => {
                    tracing::info!(target: NOTICE, "client `{name}`: waiting {patience:?} for the PLC to connect to {url}");
                }
                fault => tracing::info!(target: NOTICE, "client `{name}`: {fault}; trying again for {patience:?}"),
            }
        }
        std::thread::sleep(AGAIN.min(patience.saturating_sub(begun.elapsed())));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PLC that is there after some attempts.
    struct Late(u32, LinkFault);

    impl Link for Late {
        fn connect(&mut self) -> Result<(), LinkFault> {
            self.0 = self.0.saturating_sub(1);
            if self.0 == 0 { Ok(()) } else { Err(self.1.clone()) }
        }

        fn write(&mut self, _: &[u8]) -> Result<(), LinkFault> {
            Ok(())
        }

        fn read(&mut self, _: Duration, _: &mut [u8]) -> Result<bool, LinkFault> {
            Ok(false)
        }
    }

    fn unreachable() -> LinkFault {
        LinkFault::Unreachable { url: "tcp://plc:1".to_owned(), reason: "Connection refused".to_owned() }
    }

    #[test]
    fn a_plc_that_is_still_starting_is_waited_for() {
        assert_eq!(connect(&mut Late(3, unreachable()), "plc", Duration::from_mins(1)), Ok(()));
        let lost = LinkFault::Lost("closed by the PLC".to_owned());
        assert_eq!(connect(&mut Late(2, lost), "plc", Duration::from_mins(1)), Ok(()));
    }

    #[test]
    fn what_was_tried_is_reported() {
        let fault = connect(&mut Late(u32::MAX, unreachable()), "plc", Duration::ZERO).unwrap_err();
        assert_eq!(fault.to_string(), "unreachable: tcp://plc:1: Connection refused; tried once in 0ns");
        let fault = unreachable().tried(48, Duration::from_secs(10));
        assert_eq!(fault.to_string(), "unreachable: tcp://plc:1: Connection refused; tried 48 times in 10s");
        let refused = LinkFault::Refused { url: "s7://plc".to_owned(), reason: "no".to_owned() };
        assert_eq!(connect(&mut Late(u32::MAX, refused.clone()), "plc", Duration::from_mins(1)), Err(refused));
    }
}
