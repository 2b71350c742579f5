//! `onescan shot`: the machine of a session at one time, as a picture.
//!
//! | module | subject |
//! |---|---|
//! | [`config`] | what is asked for |
//! | [`error`] | why there is no picture |
//! | [`browser`] | the Chromium that draws, and what it is asked |
//!
//! The session runs to the time, and its page is served to a Chromium without a window. The page draws the machine alone and
//! sends the picture back, so nothing has to be guessed of when it is drawn.

mod browser;
pub mod config;
mod error;

use std::io::Write;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::mpsc;
use std::time::Duration;

use onescan_report::{OutputError, file};
use onescan_scenario::Scenario;
use onescan_scenario::compose::Member;
use onescan_server::client::Parts;
use onescan_server::end::SessionEnd;
use onescan_server::mailbox::Mailbox;
use onescan_server::published::Published;
use onescan_server::signal::{ClientName, did_you_mean};

use crate::access::admission::Admission;
use crate::error::{ExitCode, Usage};
use crate::run::in_process::in_process;
use crate::web::{self, Page};
use browser::Browser;
pub(crate) use browser::program as browser;
pub use config::{ShotConfig, Size, Theme};
pub use error::ShotError;

/// How long a browser may take to start and to draw.
const PATIENCE: Duration = Duration::from_mins(2);

/// Draws the picture, and reports where it is.
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
    let published = shown(config, &scenario)?;
    let (sender, drawn) = mpsc::channel();
    let source = web::Source {
        pictures: Some(sender),
        ..web::Source::new(&scenario, published, Mailbox::new(), "max".to_owned())
    };
    let page = Page::serve(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)), &Admission::ThisMachine, source)?;
    let picture = browser.draw(&format!("{}?{query}", page.url()), &drawn, PATIENCE)?;
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

/// The session at the time.
fn shown(config: &ShotConfig, scenario: &Scenario) -> Result<Published, ShotError> {
    let elsewhere = |name: &ClientName, member: &Member| {
        let what = if matches!(member, Member::Gateway(_)) { "a real PLC" } else { "a program of its own" };
        Usage::new(format!("client `{name}` is {what}, and a picture is of a session in this process"), None)
    };
    let mut lockstep = in_process(scenario, config.at, [], elsewhere)?;
    let published = lockstep.published();
    let _follower = published.follow(Parts::POSES);
    match lockstep.run()?.end {
        SessionEnd::Failed(failure) => Err(ShotError::Ended { at: config.at, why: failure.to_string() }),
        SessionEnd::Completed { .. } | SessionEnd::Stopped { .. } => Ok(published),
    }
}
