//! What is logged, and where.

use std::io::Write;

use super::log_writer::LogWriter;
use onescan_base::notice::NOTICE;
use tracing_subscriber::filter::{LevelFilter, Targets};

/// Log lines go to standard error: warnings, what is meant for the user, and more with `--verbose`.
/// `ONESCAN_LOG` takes precedence, as a list of `target=level`.
pub(super) fn start(verbose: u8) {
    use tracing_subscriber::layer::{Layer as _, SubscriberExt as _};
    use tracing_subscriber::util::SubscriberInitExt as _;
    let asked = std::env::var("ONESCAN_LOG").ok().map(|text| text.parse::<Targets>()).transpose();
    let (asked, wrong) = asked.map_or_else(|wrong| (None, Some(wrong)), |asked| (asked, None));
    let targets = asked.unwrap_or_else(|| targets_of(verbose));
    let log = LogWriter::to(std::io::stderr());
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(move || -> Box<dyn Write> {
            match &log {
                Ok(log) => Box::new(log.clone()),
                // Then each thread writes its own lines, and waits for whoever reads them.
                Err(_) => Box::new(std::io::stderr()),
            }
        })
        .with_ansi(onescan_report::colour::suits(&std::io::stderr()))
        .without_time()
        .with_target(verbose > 1);
    tracing_subscriber::registry().with(lines.with_filter(targets)).init();
    if let Some(wrong) = wrong {
        tracing::warn!("`ONESCAN_LOG` is not a list of `target=level` and is left out: {wrong}");
    }
}

fn targets_of(verbose: u8) -> Targets {
    match verbose {
        // What the crates of OPC UA have to say is in the errors that come of it.
        0 => Targets::new()
            .with_target("opcua", LevelFilter::OFF)
            .with_default(LevelFilter::WARN)
            .with_target(NOTICE, LevelFilter::INFO),
        1 => Targets::new().with_default(LevelFilter::INFO),
        2 => Targets::new().with_default(LevelFilter::DEBUG),
        _ => Targets::new().with_default(LevelFilter::TRACE),
    }
}
