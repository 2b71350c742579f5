//! `onescan shot`: the machine of a session at one time, as a picture, or from one time to another, as a film.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`error`] | why there is no picture |
//! | [`browser`] | the Chromium that draws, and what it is asked |
//! | [`webp`] | pictures as a film |
//!
//! The session runs to the time, and its page is served to a Chromium without a window. The page draws the machine alone and
//! sends the picture back, so nothing has to be guessed of when it is drawn. For a film the session waits at the time of each
//! picture until it is there.

mod browser;
pub mod config;
mod error;
mod webp;

use std::io::Write;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc;
use std::time::Duration;

use onescan_report::{OutputError, file};
use onescan_scenario::compose::Member;
use onescan_scenario::{Mode, Scenario};
use onescan_server::client::Parts;
use onescan_server::end::SessionEnd;
use onescan_server::lockstep::{Lockstep, Reached};
use onescan_server::mailbox::Mailbox;
use onescan_server::signal::{ClientName, did_you_mean};
use onescan_server::time::{TimeSpan, VirtualTime};

use crate::access::admission::Admission;
use crate::error::{ExitCode, Usage};
use crate::freewheel::run::{Freewheeler, run as run_free};
use crate::run::freewheel;
use crate::run::in_process::in_process;
use crate::web::{self, Page};
use browser::Browser;
pub(crate) use browser::program as browser;
pub use config::{Film, ShotConfig, Size, Theme};
pub use error::ShotError;
pub use webp::NoFilm;

/// How long a browser may take to start and to draw.
const PATIENCE: Duration = Duration::from_mins(2);

/// Draws the picture or the film, and reports where it is.
///
/// # Errors
/// See [`ShotError`].
pub fn run(config: &ShotConfig, out: &mut dyn Write) -> Result<ExitCode, ShotError> {
    let scenario = chosen(config)?;
    let query = query(config, &scenario)?;
    let browser = Browser::installed()?;
    if let Some(how) = Page::is_absent() {
        return Err(Usage::new(format!("there is nothing to draw with: {how}"), None).into());
    }
    let mut session = formed(config, &scenario)?;
    let published = session.published();
    // A view of every step: the page draws the one at which the session waits.
    let _follower = published.follow(Parts::POSES);
    go_to(config.at, &mut session)?;
    let (sender, drawn) = mpsc::channel();
    let source = web::Source {
        pictures: Some(sender),
        ..web::Source::new(&scenario, published, Mailbox::new(), "max".to_owned())
    };
    let page = Page::serve(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)), &Admission::ThisMachine, source)?;
    let mut window = browser.open(&format!("{}?{query}", page.url()))?;
    let picture = match &config.film {
        None => window.next(&drawn, PATIENCE)?,
        Some(film) => {
            let mut pictures = Vec::new();
            for t_v in film.times(config.at, scenario.plan().step()) {
                go_to(t_v, &mut session)?;
                pictures.push(window.next(&drawn, PATIENCE)?);
            }
            webp::film(&pictures, config.size, film.shown_ms()).map_err(ShotError::Film)?
        }
    };
    file::write_whole(&file::followed(&config.out), &picture)?;
    writeln!(out, "{}", config.out.display()).map_err(OutputError)?;
    Ok(ExitCode::Ok)
}

fn chosen(config: &ShotConfig) -> Result<Scenario, ShotError> {
    let mut scenario = Scenario::load(&config.scenario)?;
    for client in &config.operated {
        scenario.operate(client)?;
    }
    let Some(name) = &config.case else { return Ok(scenario) };
    let catalogue = scenario.catalogue()?;
    let case = catalogue.named(&scenario, name)?;
    Ok(scenario.with_case(&catalogue, case)?)
}

/// What the page is to draw.
fn query(config: &ShotConfig, scenario: &Scenario) -> Result<String, Usage> {
    let mut query = format!("shot={}x{}&theme={}", config.size.width, config.size.height, config.theme.word());
    if let Some(film) = &config.film {
        let step = scenario.plan().step();
        if film.times(config.at, step).len() < 2 {
            let message = format!("a film from {} to {} has no second picture", config.at, film.until);
            return Err(Usage::new(
                message,
                Some("give it a later `--until`, or more pictures with `--rate`".to_owned()),
            ));
        }
        let (from, every) = (on_step(config.at, step).as_nanos(), film.every(step).as_nanos());
        query.extend([format!("&film={from},{every}&quality={}", film.quality)]);
    }
    if let Some(view) = &config.view {
        let views: Vec<&str> = scenario.file().view.iter().map(|view| view.name.get_ref().as_str()).collect();
        let Some(number) = views.iter().position(|name| name == view) else {
            let known =
                if views.is_empty() { "it has none".to_owned() } else { format!("it has {}", views.join(", ")) };
            let help = did_you_mean(view, views.iter().copied()).unwrap_or(known);
            return Err(Usage::new(format!("the scenario has no view `{view}`"), Some(help)));
        };
        query.extend(["&view=", number.to_string().as_str()]);
    }
    Ok(query)
}

/// The first boundary at or after a time.
fn on_step(at: VirtualTime, step: TimeSpan) -> VirtualTime {
    VirtualTime::from_nanos(at.as_nanos().next_multiple_of(step.as_nanos()))
}

/// The session, about to begin.
fn formed(config: &ShotConfig, scenario: &Scenario) -> Result<Lockstep, ShotError> {
    let until = config.film.map_or(config.at, |film| film.until);
    // It is not over when its last picture is drawn.
    let until = until.checked_add(scenario.plan().step()).unwrap_or(VirtualTime::MAX);
    if let Some(seed) = config.freewheel {
        return freewheeling(scenario, seed, until);
    }
    let elsewhere = |name: &ClientName, member: &Member| {
        let what = if matches!(member, Member::Gateway(_)) { "a real PLC" } else { "a program of its own" };
        Usage::new(format!("client `{name}` is {what}, and a picture is of a session in this process"), None)
    };
    Ok(in_process(scenario, until, [], elsewhere)?)
}

/// The session without lockstep: it has run, and is shown again cycle by cycle.
fn freewheeling(scenario: &Scenario, seed: u64, until: VirtualTime) -> Result<Lockstep, ShotError> {
    let clients = freewheel::clients(Mode::Freewheel, scenario)?.into_iter().map(Freewheeler::seen).collect();
    let clocks = freewheel::clocks(scenario, seed, 1);
    let how = (&scenario.file().freewheel, scenario.timeline());
    let trace = run_free(scenario.plan(), clients, how, (until, Some(clocks)), &AtomicBool::new(false))?;
    let mut replay = trace.replay;
    replay.set_until(Some(until));
    Ok(replay)
}

/// Lets the session come to a time.
fn go_to(at: VirtualTime, session: &mut Lockstep) -> Result<(), ShotError> {
    if session.run_to(at)? == Reached::Boundary {
        return Ok(());
    }
    match session.outcome().end {
        SessionEnd::Failed(failure) => Err(ShotError::Ended { at, why: failure.to_string() }),
        SessionEnd::Completed { .. } | SessionEnd::Stopped { .. } => Ok(()),
    }
}
