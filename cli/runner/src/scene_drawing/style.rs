//! How bodies and figures look at the start, as looks say; the page does the same in `web/src/looks.ts`.

use std::collections::BTreeMap;

use onescan_plant::Frame;
use onescan_plant::scene::model::Scene;
use onescan_scenario::look_file::{Axis, LookFile};
use onescan_scenario::visible::Visible;
use onescan_scenario::{Scenario, ScenarioError};

/// Colours by name, as browsers have them.
const NAMED: [(&str, [f64; 3]); 7] = [
    ("red", [255.0, 0.0, 0.0]),
    ("orange", [255.0, 165.0, 0.0]),
    ("yellow", [255.0, 255.0, 0.0]),
    ("green", [0.0, 128.0, 0.0]),
    ("blue", [0.0, 0.0, 255.0]),
    ("white", [255.0, 255.0, 255.0]),
    ("grey", [128.0, 128.0, 128.0]),
];
/// What grows from nothing is drawn as a slice.
const GROWN_LEAST: f64 = 1e-4;

/// How a body or a figure is drawn beside what it is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Style {
    /// Red, green and blue, 0 to 255; its own without one.
    pub(super) colour: Option<[f64; 3]>,
    pub(super) is_hidden: bool,
    /// How much one sees through it, 0 to 1.
    pub(super) transparent: f64,
    pub(super) scale: f64,
    /// The shares of its lengths that are drawn, from the lower end.
    pub(super) grown: [f64; 3],
    pub(super) moved_m: [f64; 3],
    /// Turns about a point, or about its middle.
    pub(super) turns: Vec<(Frame, Option<[f64; 3]>)>,
}

impl Style {
    /// As it is without looks.
    pub(super) fn plain(colour: Option<&str>, transparent: f64) -> Self {
        let (turns, moved_m) = (Vec::new(), [0.0; 3]);
        let colour = colour.and_then(rgb);
        Self { colour, is_hidden: false, transparent, scale: 1.0, grown: [1.0; 3], moved_m, turns }
    }

    pub(super) fn is_unseen(&self) -> bool {
        self.is_hidden || self.transparent >= 1.0
    }

    /// What a look makes of it, whose value is this share of its way.
    fn take(&mut self, look: &LookFile, share: Option<f64>) {
        self.colour = look.colour.as_ref().and_then(|colour| rgb(colour.get_ref())).or(self.colour);
        self.is_hidden |= look.hidden;
        self.transparent = look.transparent.unwrap_or(self.transparent);
        self.scale *= look.scale.unwrap_or(1.0);
        let Some(share) = share else { return };
        if let Some([from, to]) = look.colours.as_ref().map(toml::Spanned::get_ref) {
            let ends = rgb(from).zip(rgb(to));
            let between = |(from, to): ([f64; 3], [f64; 3])| {
                [0, 1, 2].map(|part| from[part] + (to[part] - from[part]) * share.clamp(0.0, 1.0))
            };
            self.colour = ends.map(between).or(self.colour);
        }
        if let Some(way_m) = look.move_m {
            self.moved_m = [0, 1, 2].map(|axis| self.moved_m[axis] + way_m[axis] * share);
        }
        if let Some(turn_deg) = look.turn_deg {
            self.turns.push((turned(turn_deg, share), look.turn_about_m));
        }
        if let Some(axis) = look.grow {
            self.grown[axis_number(axis)] = share.max(GROWN_LEAST);
        }
    }
}

fn axis_number(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

/// A share of a turn about an axis that is as long as the angle, degrees.
fn turned(turn_deg: [f64; 3], share: f64) -> Frame {
    let length = turn_deg.iter().map(|part| part * part).sum::<f64>().sqrt();
    let (sine, cosine) = libm::sincos((length * share).to_radians() / 2.0);
    let [x, y, z] = turn_deg.map(|part| if length > 0.0 { part / length * sine } else { 0.0 });
    Frame { position_m: [0.0; 3], rotation_xyzw: [x, y, z, cosine] }
}

/// Red, green and blue of `#rrggbb` or of a colour's name; nothing of another text, which no scenario has.
fn rgb(text: &str) -> Option<[f64; 3]> {
    let Some(hex) = text.strip_prefix('#') else {
        return NAMED.iter().find(|(name, _)| *name == text).map(|(_, colour)| *colour);
    };
    let part = |at: usize| hex.get(at..at + 2).and_then(|part| u8::from_str_radix(part, 16).ok()).map(f64::from);
    Some([part(0)?, part(2)?, part(4)?])
}

/// How far along its way a value is: 0 at the begin, 1 at the end of `over`.
fn share_of(value: f64, over: Option<[f64; 2]>) -> f64 {
    let Some([begin, end]) = over else { return value };
    let share = (value - begin) / (end - begin);
    if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
}

/// The looks of a scenario at the start, by what they are of.
pub(super) struct Styles<'s> {
    /// The looks of each body and figure by its name, each with the share of its way.
    by_name: BTreeMap<String, Vec<(&'s LookFile, Option<f64>)>>,
}

impl<'s> Styles<'s> {
    /// Of the scenario, as a page with the bodies of this scene has them.
    ///
    /// # Errors
    /// A look or a figure of something that is not there.
    pub(super) fn of(scenario: &'s Scenario, values: Option<&[f64]>, scene: &Scene) -> Result<Self, ScenarioError> {
        let visible = visible(scene);
        let (seen, looks) = (scenario.seen(&visible)?, scenario.looks());
        let signals = scenario.plan().signals();
        let value = |name: &str| {
            let place = signals.iter().position(|signal| signal.name.as_str() == name)?;
            values?.get(place).copied()
        };
        let judged: Option<Vec<f64>> = looks.signals.iter().map(|name| value(name.as_str())).collect();
        // Without a value of each signal no condition can be judged, and looks without one count all the same.
        let active = judged.map(|judged| looks.active(&judged)).unwrap_or_default();
        let names: Vec<&String> = visible.bodies.iter().chain(looks.figures.iter().map(|one| &one.name)).collect();
        let mut by_name: BTreeMap<String, Vec<(&LookFile, Option<f64>)>> = BTreeMap::new();
        for (number, (look, bodies)) in looks.looks.iter().map(toml::Spanned::get_ref).zip(seen).enumerate() {
            if look.when.is_some() && !active.contains(&number) {
                continue;
            }
            let followed = look.follows.as_ref().and_then(|signal| value(signal.get_ref().as_str()));
            let share = followed.map(|value| share_of(value, look.over));
            for name in bodies.into_iter().filter_map(|body| names.get(body)) {
                by_name.entry((*name).clone()).or_default().push((look, share));
            }
        }
        Ok(Self { by_name })
    }

    /// Of a body of the scene.
    pub(super) fn of_body(&self, name: &str) -> Style {
        self.over(name, Style::plain(None, 0.0))
    }

    /// What looks make of it; later ones go before earlier ones.
    pub(super) fn over(&self, name: &str, mut style: Style) -> Style {
        for (look, share) in self.by_name.get(name).into_iter().flatten() {
            style.take(look, *share);
        }
        style
    }
}

/// What there is to be looked at in a scene, as a page counts it.
fn visible(scene: &Scene) -> Visible {
    let body = |form: onescan_plant::Form<'_>| {
        form.attached.map_or_else(|| form.body.to_owned(), |shape| format!("{}/{shape}", form.body))
    };
    let parts = scene.components.iter().map(|component| {
        let carrier = component.bound.body.and_then(|body| scene.bodies.get(body));
        (component.name.clone(), carrier.map(|body| body.name.clone()))
    });
    Visible { bodies: scene.forms().map(body).collect(), parts: parts.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_a_browser() {
        assert_eq!((rgb("#102030"), rgb("grey")), (Some([16.0, 32.0, 48.0]), Some([128.0; 3])));
        assert_eq!((rgb("#10203"), rgb("rot")), (None, None));
    }

    #[test]
    fn a_look_goes_as_far_as_its_value() {
        let look: LookFile = toml::from_str(
            "bodies = [\"a\"]\nfollows = \"x\"\nover = [0.0, 2.0]\nmove_m = [0.0, 0.0, 4.0]\ngrow = \"x\"\n\
             turn_deg = [0.0, 0.0, 180.0]\ncolours = [\"#000000\", \"#ff8000\"]",
        )
        .expect("a look");
        let mut style = Style::plain(None, 0.0);
        style.take(&look, Some(share_of(1.0, look.over)));
        assert_eq!((style.moved_m, style.grown), ([0.0, 0.0, 2.0], [0.5, 1.0, 1.0]));
        assert_eq!(style.colour, Some([127.5, 64.0, 0.0]));
        // a quarter of a turn about z takes x to y
        let at = Frame { position_m: [1.0, 0.0, 0.0], rotation_xyzw: [0.0, 0.0, 0.0, 1.0] };
        let [x, y, z] = at.seen_from(style.turns[0].0).position_m;
        assert!(x.abs() < 1e-12 && (y - 1.0).abs() < 1e-12 && z == 0.0, "{x} {y} {z}");
        style.take(&look, None);
        assert_eq!(style.moved_m, [0.0, 0.0, 2.0], "without a value it goes nowhere");
    }
}
