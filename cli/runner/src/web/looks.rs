//! What bodies look like: figures, views and looks of the scenario as the page has them, and which looks are on.

use std::collections::{BTreeMap, BTreeSet};

use onescan_scenario::figure::{Figure, FigureForm};
use onescan_scenario::look_file::{Axis, LookFile};
use onescan_scenario::panel_file::Seat;
use onescan_scenario::visible::Visible;
use onescan_scenario::{Scenario, ScenarioError};
use onescan_server::layout::ImageLayout;
use onescan_server::published::SessionView;
use onescan_server::signal::SignalId;
use schemars::JsonSchema;
use serde::Serialize;
use tokio::sync::watch;

use super::error::Refused;
use super::machine::{Body, Part, Shape};
use super::seats::{Seats, Viewer};
use super::training::{Role, Training};

/// A place from which the machine is seen.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct View {
    name: String,
    position_m: [f64; 3],
    target_m: [f64; 3],
}

/// How bodies look while a condition holds, always without one, or by the value of the signal that it follows; bodies and the
/// signal by their places.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(super) struct Look {
    when: Option<String>,
    bodies: Vec<usize>,
    colour: Option<String>,
    #[schemars(default)]
    hidden: bool,
    transparent: Option<f64>,
    scale: Option<f64>,
    follows: Option<usize>,
    over: Option<[f64; 2]>,
    takes_s: Option<f64>,
    move_m: Option<[f64; 3]>,
    turn_deg: Option<[f64; 3]>,
    turn_about_m: Option<[f64; 3]>,
    grow: Option<LookAxis>,
    colours: Option<[String; 2]>,
    run_m_s: Option<[f64; 3]>,
}

/// The axis along which a body grows.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum LookAxis {
    X,
    Y,
    Z,
}

/// The views of a scenario.
pub(super) fn views(scenario: &Scenario) -> Vec<View> {
    let view = |file: &onescan_scenario::look_file::ViewFile| View {
        name: file.name.get_ref().clone(),
        position_m: file.position_m,
        target_m: file.target_m,
    };
    scenario.file().view.iter().map(view).collect()
}

/// What there is to be looked at in a scenario's plants.
pub(super) fn visible(bodies: &[Body], parts: &[Part]) -> Visible {
    Visible {
        bodies: bodies.iter().map(|body| body.name.clone()).collect(),
        parts: parts.iter().map(|part| (part.name.clone(), part.body.clone())).collect(),
    }
}

/// The looks of a scenario, and its figures, which come behind the bodies of its plants.
///
/// # Errors
/// A look of something that is not there.
pub(super) fn of(scenario: &Scenario, bodies: &mut Vec<Body>, visible: &Visible) -> Result<Vec<Look>, ScenarioError> {
    let seen = scenario.seen(visible)?;
    for figure in &scenario.looks().figures {
        let on = figure.on.as_ref().and_then(|on| bodies.iter().position(|body| body.name == *on));
        bodies.push(drawn(figure, on));
    }
    let places: BTreeMap<&str, usize> =
        scenario.plan().signals().iter().enumerate().map(|(place, signal)| (signal.name.as_str(), place)).collect();
    let look = |(file, bodies): (&toml::Spanned<LookFile>, Vec<usize>)| look(file.get_ref(), bodies, &places);
    Ok(scenario.looks().looks.iter().zip(seen).map(look).collect())
}

fn look(file: &LookFile, bodies: Vec<usize>, places: &BTreeMap<&str, usize>) -> Look {
    Look {
        when: file.when.as_ref().map(|when| when.get_ref().clone()),
        bodies,
        colour: file.colour.as_ref().map(|colour| colour.get_ref().clone()),
        hidden: file.hidden,
        transparent: file.transparent,
        scale: file.scale,
        follows: file.follows.as_ref().and_then(|signal| places.get(signal.get_ref().as_str()).copied()),
        over: file.over,
        takes_s: file.takes_s,
        move_m: file.move_m,
        turn_deg: file.turn_deg,
        turn_about_m: file.turn_about_m,
        grow: file.grow.map(|axis| match axis {
            Axis::X => LookAxis::X,
            Axis::Y => LookAxis::Y,
            Axis::Z => LookAxis::Z,
        }),
        colours: file.colours.as_ref().map(|colours| colours.get_ref().clone()),
        run_m_s: file.run_m_s,
    }
}

fn drawn(figure: &Figure, on: Option<usize>) -> Body {
    Body {
        name: figure.name.clone(),
        kind: "figure",
        shape: match figure.form {
            FigureForm::Box { size_m } => Shape::Box { size_m },
            FigureForm::Sphere { radius_m } => Shape::Sphere { radius_m },
            FigureForm::Round { radius_m, top_radius_m, length_m, is_open } => {
                Shape::Round { radius_m, top_radius_m, length_m, open: is_open }
            }
        },
        position_m: figure.place.position_m,
        rotation: figure.place.rotation_xyzw,
        on,
        colour: figure.colour.clone(),
        transparent: figure.transparent,
        density_kg_m3: None,
    }
}

/// Judges which looks are on.
#[derive(Clone, Debug, Default)]
pub(super) struct Judge {
    looks: onescan_scenario::look::Looks,
    signals: Vec<SignalId>,
}

impl Judge {
    /// Of the looks of a scenario.
    pub(super) fn of(scenario: &Scenario) -> Self {
        let signals = scenario.plan().signals();
        let layout = ImageLayout::new(signals);
        let ids: BTreeMap<&str, SignalId> =
            layout.signals().zip(signals).map(|(id, signal)| (signal.name.as_str(), id)).collect();
        let looks = scenario.looks().clone();
        // conditions are on signals of the plan
        let signals = looks.signals.iter().filter_map(|signal| ids.get(signal.as_str()).copied()).collect();
        Self { looks, signals }
    }

    /// The places of the looks whose condition holds in a view.
    pub(super) fn active(&self, view: &SessionView, layout: &ImageLayout) -> Vec<usize> {
        let value =
            |signal: &SignalId| layout.ty(*signal).as_f64(layout.bytes(*signal, &view.image)).unwrap_or(f64::NAN);
        let values: Vec<f64> = self.signals.iter().map(value).collect();
        self.looks.active(&values)
    }
}

/// A view that somebody calls for all viewers.
#[derive(Debug)]
pub(super) struct Called {
    views: BTreeSet<String>,
    /// The panels of trainers.
    trainers: BTreeSet<String>,
    /// The view that was called last, and how many there were.
    last: watch::Sender<(u64, String)>,
    /// Whether it is shown to those who come later, too.
    is_kept: bool,
}

impl Called {
    /// Of a scenario's views. In a lesson, whoever comes is shown the last one, and at first that of the lesson.
    pub(super) fn among(scenario: &Scenario, training: Option<&Training>) -> Self {
        let file = scenario.file();
        let trainers = file.panel.iter().filter(|panel| panel.seat == Seat::Trainer);
        Self {
            views: file.view.iter().map(|view| view.name.get_ref().clone()).collect(),
            trainers: trainers.map(|panel| panel.name.get_ref().clone()).collect(),
            last: watch::Sender::new(
                training.and_then(|training| training.view.clone()).map_or((0, String::new()), |view| (1, view)),
            ),
            is_kept: training.is_some(),
        }
    }

    /// Whether a viewer may show this view to everybody. A lesson's is called on the trainer's page; elsewhere, where there are
    /// panels of trainers, whoever calls sits at one of them.
    pub(super) fn may_call(
        &self,
        view: &str,
        (viewer, role): (Viewer, Option<Role>),
        seats: &Seats,
    ) -> Result<(), Refused> {
        if !self.views.contains(view) {
            return Err(Refused::NoView(view.to_owned()));
        }
        match role {
            Some(Role::Trainer) => Ok(()),
            Some(Role::Trainee) => Err(Refused::Trainee),
            None if self.trainers.is_empty() || seats.sits_at_one_of(&self.trainers, viewer) => Ok(()),
            None => Err(Refused::NoTrainer),
        }
    }

    /// Shows a view to everybody, on all pages of the session.
    pub(super) fn call(&self, view: String) {
        self.last.send_modify(|(count, last)| (*count, *last) = (*count + 1, view));
    }

    /// What is called from now on, and what was last in a lesson.
    pub(super) fn follow(&self) -> watch::Receiver<(u64, String)> {
        let mut called = self.last.subscribe();
        let is_any = called.borrow().0 > 0;
        if self.is_kept && is_any {
            called.mark_changed();
        }
        called
    }
}
