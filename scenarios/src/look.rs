//! Looks: what bodies look like while something holds, or by the value of a signal.
//!
//! A look is for the eye. It is judged on what a session publishes, beside the session, and leaves no trace in it.

use onescan_base::array;
use onescan_server::signal::{SignalName, SignalType, did_you_mean};
use toml::Spanned;

use crate::error::Wrong;
use crate::expect::Present;
use crate::expectations::place_within;
use crate::figure::{Figure, check_views, figures};
use crate::file::ScenarioFile;
use crate::look_file::LookFile;
use crate::panel::check_colour;

/// The looks of a scenario, bound to its signals.
#[derive(Clone, Debug, Default)]
pub struct Looks {
    /// What is drawn beside the bodies of plants.
    pub figures: Vec<Figure>,
    /// The looks as they are written, one for each of `each`.
    pub looks: Vec<Spanned<LookFile>>,
    /// By the number of the look: its condition, if it has one.
    conditions: Vec<Option<Present>>,
    /// The signals that conditions are judged by, in the order of the values for [`Self::active`].
    pub signals: Vec<SignalName>,
}

impl Looks {
    /// The numbers of the looks whose condition holds with these values, one for each of `signals`; looks without a
    /// condition are not among them.
    pub fn active(&self, values: &[f64]) -> Vec<usize> {
        let holds = |condition: &Option<Present>| condition.as_ref().is_some_and(|condition| condition.holds(values));
        self.conditions.iter().enumerate().filter(|(_, condition)| holds(condition)).map(|(look, _)| look).collect()
    }

    pub(crate) fn bind(file: &ScenarioFile, text: &str) -> Result<Self, Wrong> {
        check_views(&file.view)?;
        let figures = figures(file)?;
        let (known, mut columns) = (file.known_signals(), Vec::new());
        let (mut looks, mut conditions) = (Vec::new(), Vec::new());
        for look in &file.look {
            looks.extend(written_out(look)?);
        }
        for look in &looks {
            check(look, file)?;
            let bound = look.get_ref().when.as_ref().map(|when| {
                Present::parse(when.get_ref(), &known, &mut columns).map_err(|error| Wrong {
                    message: error.to_string(),
                    place: place_within(when, text, &error.place),
                    help: error.help,
                })
            });
            conditions.push(bound.transpose()?);
        }
        // Columns are names of the file's own signals.
        let signals = columns.iter().filter_map(|column| SignalName::new(column.as_str()).ok()).collect();
        Ok(Self { figures, looks, conditions, signals })
    }
}

fn at<T>(place: &Spanned<T>, message: impl Into<String>, help: &str) -> Wrong {
    Wrong { message: message.into(), place: place.span(), help: (!help.is_empty()).then(|| help.to_owned()) }
}

/// A look for each number of its `each`; itself if it has none.
fn written_out(look: &Spanned<LookFile>) -> Result<Vec<Spanned<LookFile>>, Wrong> {
    let Some([first, last]) = look.get_ref().each else { return Ok(vec![look.clone()]) };
    if last < first || last - first >= array::NAMES_MAX {
        let message = format!("`each` counts from {first} to {last}");
        return Err(at(look, message, "write the lower number first, and ten thousand at most"));
    }
    let copy = |index: usize| -> Result<Spanned<LookFile>, Wrong> {
        let text = |one: &Spanned<String>| Spanned::new(one.span(), array::at_index(one.get_ref(), index));
        let inner = look.get_ref();
        let follows = inner.follows.as_ref().map(|signal| {
            let name = SignalName::new(array::at_index(signal.get_ref().as_str(), index));
            name.map(|name| Spanned::new(signal.span(), name)).map_err(|bad| at(signal, bad.to_string(), ""))
        });
        let copy = LookFile {
            bodies: inner.bodies.iter().map(text).collect(),
            parts: inner.parts.iter().map(text).collect(),
            when: inner.when.as_ref().map(text),
            follows: follows.transpose()?,
            ..inner.clone()
        };
        Ok(Spanned::new(look.span(), copy))
    };
    (first..=last).map(copy).collect()
}

/// What can be said of a look without a plant.
fn check(look: &Spanned<LookFile>, file: &ScenarioFile) -> Result<(), Wrong> {
    let inner = look.get_ref();
    if inner.bodies.is_empty() && inner.parts.is_empty() {
        return Err(at(look, "the look is of nothing", "name `bodies` or `parts`"));
    }
    let is_driven = inner.grow.is_some() || inner.colours.is_some() || inner.moves() || inner.run_m_s.is_some();
    let is_plain = inner.colour.is_some() || inner.hidden || inner.transparent.is_some() || inner.scale.is_some();
    if !is_driven && !is_plain && inner.follows.is_none() {
        let help = "write `colour`, `hidden`, `transparent` or `scale`, or with `follows` what its value drives";
        return Err(at(look, "the look changes nothing", help));
    }
    check_numbers(look)?;
    if let Some(colour) = &inner.colour {
        check_colour(colour.get_ref(), colour.span())?;
    }
    if let Some(colours) = &inner.colours {
        for colour in colours.get_ref() {
            check_colour(colour, colours.span())?;
        }
    }
    match &inner.follows {
        None if is_driven => Err(at(look, "nothing drives the look", "name a signal with `follows`")),
        None => Ok(()),
        Some(signal) if !is_driven => {
            let help = "write `move_m`, `turn_deg`, `grow`, `colours` or `run_m_s`";
            Err(at(signal, format!("the value of `{}` drives nothing", signal.get_ref()), help))
        }
        Some(signal) => check_signal(signal, file),
    }
}

fn check_signal(name: &Spanned<SignalName>, file: &ScenarioFile) -> Result<(), Wrong> {
    let Some(signal) = file.signals.get(name.get_ref()).map(Spanned::get_ref) else {
        let message = format!("the look follows a signal `{}` that is not declared", name.get_ref());
        let help = did_you_mean(name.get_ref().as_str(), file.signals.keys().map(SignalName::as_str));
        return Err(Wrong { message, place: name.span(), help });
    };
    let is_number = signal.ty == SignalType::BOOL || signal.ty.as_f64(&vec![0; signal.ty.size()]).is_some();
    if !is_number {
        return Err(at(name, format!("`{}` is {}, and a look follows a number", name.get_ref(), signal.ty), ""));
    }
    Ok(())
}

fn check_numbers(look: &Spanned<LookFile>) -> Result<(), Wrong> {
    let inner = look.get_ref();
    if let Some(share) = inner.transparent
        && !(0.0..=1.0).contains(&share)
    {
        return Err(at(look, format!("`transparent` is {share}, not 0 to 1"), ""));
    }
    for (key, number) in [("scale", inner.scale), ("takes_s", inner.takes_s)] {
        if number.is_some_and(|number| !number.is_finite() || number <= 0.0) {
            return Err(at(look, format!("`{key}` is not above 0"), ""));
        }
    }
    if let Some([begin, end]) = inner.over
        && (!begin.is_finite() || !end.is_finite() || begin.total_cmp(&end).is_eq())
    {
        return Err(at(look, "`over` has no two different ends", ""));
    }
    let ways = [inner.move_m, inner.turn_deg, inner.turn_about_m, inner.run_m_s];
    if !ways.iter().flatten().flatten().all(|part| part.is_finite()) {
        return Err(at(look, "the look has a way without numbers", ""));
    }
    if inner.turn_about_m.is_some() && inner.turn_deg.is_none() {
        return Err(at(look, "`turn_about_m` needs `turn_deg`", ""));
    }
    if inner.grow.is_some() && inner.over.is_none() {
        return Err(at(look, "`grow` needs `over`", "write at which values there is nothing, and all of it"));
    }
    if inner.takes_s.is_some() && inner.over.is_none() {
        return Err(at(look, "`takes_s` needs `over`", "write at which values the way begins and ends"));
    }
    Ok(())
}

impl LookFile {
    /// Whether it moves what it is of.
    pub(crate) fn moves(&self) -> bool {
        self.move_m.is_some() || self.turn_deg.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = r#"
version = 1
step = "10ms"
until = "1s"
[signals]
Hot = { type = "LREAL", writer = "plant", unit = "°C" }
Up = { type = "BOOL", writer = "plant" }
Text = { type = "STRING[8]", writer = "plant" }
[clients.plant]
kind = "plant"
scene = "plant.toml"
"#;

    fn bound(more: &str) -> Result<Looks, (String, String)> {
        let text = format!("{HEAD}{more}");
        let mut file: ScenarioFile =
            toml::from_str(&text).map_err(|error| (error.message().to_owned(), String::new()))?;
        crate::structure::expand(&mut file).expect("signals");
        Looks::bind(&file, &text).map_err(|found| (found.message, text[found.place].to_owned()))
    }

    #[test]
    fn conditions_are_judged_on_one_image() {
        let looks = bound(
            "[[look]]\nbodies = [\"a\"]\nwhen = \"Hot > 80 °C and Up\"\ncolour = \"red\"\n\
             [[look]]\nbodies = [\"a\"]\nfollows = \"Hot\"\nover = [0.0, 1.0]\ngrow = \"z\"\n\
             [[look]]\nbodies = [\"a\"]\nwhen = \"not Up\"\nhidden = true\n",
        )
        .expect("looks");
        let names: Vec<&str> = looks.signals.iter().map(SignalName::as_str).collect();
        assert_eq!(names, ["Hot", "Up"]);
        assert_eq!(looks.active(&[90.0, 1.0]), [0]);
        assert_eq!(looks.active(&[90.0, 0.0]), [2]);
        assert_eq!(looks.active(&[70.0, 1.0]), [0; 0]);
    }

    #[test]
    fn a_look_of_many_is_one_for_each() {
        let looks = bound("[[look]]\neach = [1, 3]\nbodies = [\"arm[i]\"]\nwhen = \"Hot > 80\"\ncolour = \"red\"\n")
            .expect("looks");
        let bodies: Vec<&str> = looks.looks.iter().map(|look| look.get_ref().bodies[0].get_ref().as_str()).collect();
        assert_eq!(bodies, ["arm[1]", "arm[2]", "arm[3]"]);
        assert_eq!(looks.active(&[90.0]), [0, 1, 2]);
    }

    #[test]
    fn figures_of_an_array_stand_in_a_circle_or_in_a_row() {
        let looks = bound(
            "[[figure]]\nname = \"wall[0..3]\"\nshape = \"box\"\nsize_m = [1.0, 1.0, 1.0]\nposition_m = [2.0, 0.0, 0.0]\n\
             turn_about_m = [0.0, 0.0, 0.0]\n\
             [[figure]]\nname = \"post[1..2]\"\nshape = \"cylinder\"\nradius_m = 0.1\nlength_m = 1.0\nstep_m = [0.0, 3.0, 0.0]\n\
             on = \"wall[i]\"\n",
        )
        .expect("figures");
        let places: Vec<_> = looks.figures.iter().map(|one| one.place.position_m.map(f64::round)).collect();
        assert_eq!(places[..4], [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-2.0, 0.0, 0.0], [0.0, -2.0, 0.0]]);
        assert_eq!(places[4..], [[0.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
        assert_eq!(looks.figures[5].on.as_deref(), Some("wall[2]"));
    }

    #[test]
    fn each_fault_is_reported_at_its_place() {
        let look = |more: &str| bound(&format!("[[look]]\n{more}\n")).expect_err("wrong");
        let (message, place) = look("bodies = [\"a\"]\nwhen = \"Hto > 80\"\ncolour = \"red\"");
        assert!(message.contains("Hto"), "{message}");
        assert_eq!(place, "Hto");
        assert!(look("bodies = [\"a\"]\nwhen = \"rose(Up)\"\ncolour = \"red\"").0.contains("one image"));
        assert!(look("colour = \"red\"").0.contains("of nothing"));
        assert!(look("bodies = [\"a\"]\nwhen = \"Up\"").0.contains("changes nothing"));
        assert_eq!(look("bodies = [\"a\"]\ncolour = \"rot\""), ("`rot` is not a colour".into(), "\"rot\"".into()));
        assert!(look("bodies = [\"a\"]\nmove_m = [0, 0, 1]").0.contains("nothing drives"));
        assert!(look("bodies = [\"a\"]\nfollows = \"Hot\"").0.contains("drives nothing"));
        assert!(look("bodies = [\"a\"]\nfollows = \"Hut\"\nmove_m = [0, 0, 1]").0.contains("not declared"));
        assert!(look("bodies = [\"a\"]\nfollows = \"Text\"\nmove_m = [0, 0, 1]").0.contains("follows a number"));
        assert!(look("bodies = [\"a\"]\nfollows = \"Hot\"\ngrow = \"z\"").0.contains("needs `over`"));
        assert!(look("bodies = [\"a\"]\ntransparent = 2.0").0.contains("not 0 to 1"));
        assert!(look("bodies = [\"a\"]\nscale = 0.0").0.contains("not above 0"));
        let figure = |more: &str| bound(&format!("[[figure]]\nname = \"a\"\n{more}\n")).expect_err("wrong").0;
        assert!(figure("shape = \"box\"").contains("needs `size_m`"));
        assert!(figure("shape = \"box\"\nsize_m = [1, 0, 1]").contains("not a length"));
        assert!(figure("shape = \"sphere\"\nradius_m = 1.0\nlength_m = 1.0").contains("does not have"));
        let later = "shape = \"sphere\"\nradius_m = 1.0\non = \"b\"\n[[figure]]\nname = \"b\"\nshape = \"sphere\"\nradius_m = 1.0";
        assert!(figure(later).contains("comes later"));
        let view = "[[view]]\nname = \"front\"\nposition_m = [0, 0, 1]\ntarget_m = [0, 0, 1]\n";
        assert!(bound(view).expect_err("wrong").0.contains("the place where it is"));
    }
}
