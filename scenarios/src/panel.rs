//! What must hold of a panel before anybody sits at it.

use std::ops::Range;

use onescan_links::gateway::HandshakeKind;
use onescan_server::signal::{SignalName, SignalType, did_you_mean};
use toml::Spanned;

use crate::disturbance_file::DisturbanceFile;
use crate::error::Wrong;
use crate::file::{ClientFile, ScenarioFile, SignalFile};
use crate::panel_file::{ElementFile, ElementKind, FailureName, PageFile, PanelFile};
use crate::timed::Timed;

/// Colours by name, beside `#rrggbb`.
const COLOURS: &[&str] = &["red", "orange", "yellow", "green", "blue", "white", "grey"];
const COLUMNS_MAX: u32 = 24;
const ROWS_MAX: u32 = 100;

/// What is wrong at `place`.
fn at<T>(place: &Spanned<T>, message: String, help: Option<&str>) -> Wrong {
    Wrong { message, place: place.span(), help: help.map(str::to_owned) }
}

/// Checks all panels of a scenario whose signals are written out.
pub(crate) fn check(file: &ScenarioFile) -> Result<(), Wrong> {
    for (index, panel) in file.panel.iter().enumerate() {
        let name = panel.name.get_ref();
        if name.trim().is_empty() {
            return Err(at(&panel.name, "a panel needs a name".to_owned(), None));
        }
        if file.panel[..index].iter().any(|other| other.name.get_ref() == name) {
            return Err(at(&panel.name, format!("there are two panels `{name}`"), None));
        }
        if panel.columns == 0 || panel.columns > COLUMNS_MAX {
            let message = format!("panel `{name}` has {} columns; it may have 1 to {COLUMNS_MAX}", panel.columns);
            return Err(at(&panel.name, message, None));
        }
        if let Some(page) = &panel.page {
            check_page(file, page)?;
        }
        for (index, element) in panel.element.iter().enumerate() {
            check_place(panel, element, &panel.element[..index])?;
            check_action(file, element.get_ref())?;
            check_binding(file, element)?;
            check_looks(element)?;
        }
    }
    Ok(())
}

/// Which page is shown is a number that people write.
fn check_page(file: &ScenarioFile, page: &Spanned<PageFile>) -> Result<(), Wrong> {
    let PageFile { signal: name, value } = page.get_ref();
    let signal = declared(file, name)?;
    let is_whole = matches!(signal.ty, SignalType::Elementary(ty) if ty.is_integer());
    if !is_whole || signal.ty.parse_text(&value.to_string()).is_err() {
        let message = format!("`{}` is {}, which is never {value}", name.get_ref(), signal.ty);
        return Err(at(page, message, Some("pages are numbered by a signal such as INT")));
    }
    refuse_plants(file, signal, name)
}

/// On the grid, and on nothing else.
fn check_place(
    panel: &PanelFile,
    element: &Spanned<ElementFile>,
    before: &[Spanned<ElementFile>],
) -> Result<(), Wrong> {
    let ElementFile { at: [column, row], span: [wide, high], .. } = *element.get_ref();
    let fits = wide > 0
        && high > 0
        && column.checked_add(wide).is_some_and(|end| end <= panel.columns)
        && row.checked_add(high).is_some_and(|end| end <= ROWS_MAX);
    if !fits {
        let message =
            format!("the element reaches beyond the {} columns and {ROWS_MAX} rows of its panel", panel.columns);
        return Err(at(element, message, Some("columns and rows count from 0")));
    }
    let apart = |other: &ElementFile| {
        let ([left, top], [across, down]) = (other.at, other.span);
        column + wide <= left || left + across <= column || row + high <= top || top + down <= row
    };
    if let Some(other) = before.iter().find(|other| !apart(other.get_ref())) {
        let [left, top] = other.get_ref().at;
        let message = format!("the element lies on the one at column {left}, row {top}");
        return Err(at(element, message, None));
    }
    Ok(())
}

/// A session is reset by a button that is let go by itself, and only where everybody in it can begin again.
fn check_action(file: &ScenarioFile, element: &ElementFile) -> Result<(), Wrong> {
    let Some(action) = &element.action else { return Ok(()) };
    if element.kind != ElementKind::Button {
        return Err(at(action, "only a button has an `action`".to_owned(), Some("it acts once for each press")));
    }
    for (key, is_there) in [("failure", element.failure.is_some()), ("disturbance", element.disturbance.is_some())] {
        if is_there {
            let help = "a reset ends failures and disturbances; give the button a `signal`, or the action alone";
            return Err(at(action, format!("an element has an `action` or a `{key}`, not both"), Some(help)));
        }
    }
    if element.latching {
        return Err(at(action, "a button with an `action` is not `latching`".to_owned(), Some("it acts once")));
    }
    let counted = |client: &ClientFile| matches!(client, ClientFile::Gateway { gateway, .. } if gateway.handshake == HandshakeKind::Frames);
    match file.clients.iter().find(|(_, client)| counted(client.get_ref())) {
        None => Ok(()),
        Some((name, _)) => {
            let message =
                format!("the session cannot be reset: nobody here can start the program of client `{name}` again");
            let help =
                "a PLC with `handshake = \"frames\"` goes by its own clock; one that runs the instrumented program can";
            Err(at(action, message, Some(help)))
        }
    }
}

/// The signals are there, have a type that goes with the element, and are not written by a machine.
fn check_binding(file: &ScenarioFile, element: &Spanned<ElementFile>) -> Result<(), Wrong> {
    let inner = element.get_ref();
    if let Some(failure) = &inner.failure {
        return check_failure(inner, failure);
    }
    if let Some(disturbance) = &inner.disturbance {
        return check_disturbance(inner, disturbance);
    }
    match (inner.kind, &inner.signal, &inner.signal_y) {
        (ElementKind::Alarms, None, None) => return Ok(()),
        (ElementKind::Button, None, None) if inner.action.is_some() => return Ok(()),
        (kind, _, Some(signal)) if kind != ElementKind::Joystick => {
            return Err(at(signal, "only a joystick has two signals".to_owned(), None));
        }
        (_, Some(_), _) => {}
        (_, None, _) => return Err(at(element, "the element needs a `signal`".to_owned(), None)),
    }
    for name in inner.signal.iter().chain(&inner.signal_y) {
        check_signal(file, inner.kind, name)?;
    }
    Ok(())
}

/// A failure is caused by a switch or while a button is pressed, and shown by a lamp. Whether the component has that mode is
/// known when its plant is read.
fn check_failure(element: &ElementFile, failure: &Spanned<FailureName>) -> Result<(), Wrong> {
    if let Some(signal) = element.signal.as_ref().or(element.signal_y.as_ref()) {
        return Err(at(signal, "an element has a `signal` or a `failure`, not both".to_owned(), None));
    }
    if let Some(disturbance) = &element.disturbance {
        return Err(at(disturbance, "an element has a `failure` or a `disturbance`, not both".to_owned(), None));
    }
    if !matches!(element.kind, ElementKind::Switch | ElementKind::Button | ElementKind::Lamp) {
        return Err(at(failure, "only a switch, a button and a lamp can have a `failure`".to_owned(), None));
    }
    if failure.get_ref().parts().is_none() {
        return Err(at(failure, "a failure is written `component.mode`".to_owned(), Some("as in `wall.leak`")));
    }
    Ok(())
}

/// The same for a fault of signals, which lasts as long as the switch is on. Its signals and its own keys are checked when it
/// is bound.
fn check_disturbance(element: &ElementFile, disturbance: &Spanned<DisturbanceFile>) -> Result<(), Wrong> {
    if let Some(signal) = element.signal.as_ref().or(element.signal_y.as_ref()) {
        return Err(at(signal, "an element has a `signal` or a `disturbance`, not both".to_owned(), None));
    }
    if !matches!(element.kind, ElementKind::Switch | ElementKind::Button | ElementKind::Lamp) {
        return Err(at(disturbance, "only a switch, a button and a lamp can have a `disturbance`".to_owned(), None));
    }
    if disturbance.get_ref().says_when() {
        let message = "the disturbance of a panel comes and goes by somebody's hand".to_owned();
        return Err(at(disturbance, message, Some("leave out `from`, `until`, `when`, `nth` and `for`")));
    }
    Ok(())
}

fn declared<'f>(file: &'f ScenarioFile, name: &Spanned<SignalName>) -> Result<&'f SignalFile, Wrong> {
    file.signals.get(name.get_ref()).map(Spanned::get_ref).ok_or_else(|| {
        let message = format!("the panel has a signal `{}` that is not declared", name.get_ref());
        let help = did_you_mean(name.get_ref().as_str(), file.signals.keys().map(SignalName::as_str));
        Wrong { message, place: name.span(), help }
    })
}

/// People cannot write what a plant writes.
fn refuse_plants(file: &ScenarioFile, signal: &SignalFile, name: &Spanned<SignalName>) -> Result<(), Wrong> {
    let writer = file.clients.get(&signal.writer).map(Spanned::get_ref);
    if !matches!(writer, Some(ClientFile::Plant { .. })) {
        return Ok(());
    }
    let message =
        format!("`{}` is written by the plant `{}`, and people cannot write it", name.get_ref(), signal.writer);
    let help = "give it a writer of `kind = \"operator\"`, or show it with a lamp or a number";
    Err(at(name, message, Some(help)))
}

fn check_signal(file: &ScenarioFile, kind: ElementKind, name: &Spanned<SignalName>) -> Result<(), Wrong> {
    let signal = declared(file, name)?;
    if let Some(wanted) = misfit(kind, signal) {
        return Err(at(name, format!("`{}` is {}; {wanted}", name.get_ref(), signal.ty), None));
    }
    if kind.writes() || kind == ElementKind::Alarms {
        return refuse_plants(file, signal, name);
    }
    Ok(())
}

/// What an element of this kind needs that a signal is not.
fn misfit(kind: ElementKind, signal: &SignalFile) -> Option<&'static str> {
    if let SignalType::Bytes(_) = signal.ty {
        return Some("a line of bytes has no value that people show or write");
    }
    let is_bool = signal.ty == SignalType::BOOL;
    let is_number = !is_bool && signal.ty.as_f64(&vec![0; signal.ty.size()]).is_some();
    match kind {
        ElementKind::Button | ElementKind::Switch | ElementKind::Lamp => {
            (!is_bool).then_some("a button, a switch and a lamp need BOOL")
        }
        ElementKind::EmergencyStop => (!is_bool).then_some("an emergency stop is BOOL"),
        ElementKind::Alarms => (!is_bool).then_some("what acknowledges alarms is BOOL"),
        ElementKind::Selector if signal.names.pairs().is_empty() => {
            Some("a selector needs a signal with `names` for its values")
        }
        ElementKind::Slider | ElementKind::Joystick | ElementKind::Bar => {
            (!is_number).then_some("a slider, a joystick and a bar need a number")
        }
        ElementKind::Number | ElementKind::Trend => {
            (!is_number && !is_bool).then_some("it has no value that can be shown as a number")
        }
        ElementKind::Selector => None,
    }
}

/// Range and colour.
fn check_looks(element: &Spanned<ElementFile>) -> Result<(), Wrong> {
    let inner = element.get_ref();
    if let (Some(min), Some(max)) = (inner.min, inner.max)
        && (!min.is_finite() || !max.is_finite() || min >= max)
    {
        return Err(at(element, format!("`min` {min} is not below `max` {max}"), None));
    }
    if inner.latching && inner.kind != ElementKind::Button {
        return Err(at(element, "only a button can be `latching`".to_owned(), Some("a switch always is")));
    }
    if let Some(part) = inner.part.as_ref().filter(|_| !inner.kind.is_key()) {
        let message = "only a button, a switch and an emergency stop lie on a `part`".to_owned();
        return Err(at(part, message, Some("a click presses it, and gives no number")));
    }
    inner.colour.as_ref().map_or(Ok(()), |colour| check_colour(colour, element.span()))
}

/// A colour that stands at `place`.
pub(crate) fn check_colour(colour: &str, place: Range<usize>) -> Result<(), Wrong> {
    let is_hex = colour
        .strip_prefix('#')
        .is_some_and(|hex| hex.len() == 6 && hex.bytes().all(|digit| digit.is_ascii_hexdigit()));
    if is_hex || COLOURS.contains(&colour) {
        return Ok(());
    }
    let help = Some(format!("write `#rrggbb` or one of {}", COLOURS.join(", ")));
    Err(Wrong { message: format!("`{colour}` is not a colour"), place, help })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = r#"
version = 1
step = "10ms"
until = "1s"
[signals]
Start = { type = "BOOL", writer = "desk" }
Speed = { type = "REAL", writer = "desk" }
Mode = { type = "INT", writer = "desk", names = { 0 = "off", 1 = "on" } }
Seen = { type = "BOOL", writer = "plant" }
[clients.desk]
kind = "operator"
[clients.plant]
kind = "plant"
scene = "plant.toml"
[[panel]]
name = "desk"
"#;

    /// What is said of a panel with these elements, and where.
    fn reported(elements: &str) -> Result<(), (String, String)> {
        let text = format!("{HEAD}{elements}");
        let mut file: ScenarioFile = toml::from_str(&text).expect("a scenario");
        crate::structure::expand(&mut file).expect("signals");
        check(&file).map_err(|found| (found.message, text[found.place].to_owned()))
    }

    fn element(kind: &str, more: &str) -> String {
        format!("[[panel.element]]\nkind = \"{kind}\"\n{more}\n")
    }

    #[test]
    fn what_goes_together_is_taken() {
        let elements = [
            element("button", "signal = \"Start\"\nat = [0, 0]\ncolour = \"#1d8a42\"\nlatching = true"),
            element("slider", "signal = \"Speed\"\nat = [1, 0]\nspan = [5, 1]\nmin = -1.0\nmax = 1.0"),
            element("selector", "signal = \"Mode\"\nat = [0, 1]"),
            element("lamp", "signal = \"Seen\"\nat = [1, 1]\ncolour = \"red\""),
            element("joystick", "signal = \"Speed\"\nsignal_y = \"Speed\"\nat = [2, 1]"),
            element("switch", "failure = \"wall.leak\"\nat = [3, 1]"),
            element("switch", "disturbance = { signal = \"Speed\", kind = \"stuck\" }\nat = [4, 1]"),
            element("emergency-stop", "signal = \"Start\"\nat = [5, 1]"),
            element("alarms", "at = [0, 2]\nspan = [6, 3]"),
            element("alarms", "signal = \"Start\"\nat = [0, 5]"),
            element("button", "action = \"reset\"\nlabel = \"Begin again\"\nat = [1, 5]"),
            element("button", "action = \"reset\"\nsignal = \"Start\"\npart = \"lid\"\nat = [2, 5]"),
        ];
        assert_eq!(reported(&elements.concat()), Ok(()));
    }

    #[test]
    fn a_key_may_lie_on_the_machine_and_nothing_else() {
        for kind in ["button", "switch", "emergency-stop"] {
            assert_eq!(reported(&element(kind, "signal = \"Start\"\nat = [0, 0]\npart = \"lid\"")), Ok(()), "{kind}");
        }
        let (message, place) =
            reported(&element("slider", "signal = \"Speed\"\nat = [0, 0]\npart = \"lid\"")).expect_err("no key");
        assert!(
            message.starts_with("only a button, a switch and an emergency stop") && place == "\"lid\"",
            "{message}"
        );
    }

    #[test]
    fn a_session_is_reset_by_a_plain_button() {
        let wrong = |kind: &str, more: &str| {
            reported(&element(kind, &format!("action = \"reset\"\nat = [0, 0]\n{more}"))).expect_err("wrong")
        };
        for (kind, more, message) in [
            ("switch", "signal = \"Start\"", "only a button has an `action`"),
            ("lamp", "signal = \"Start\"", "only a button has an `action`"),
            ("button", "failure = \"wall.leak\"", "an `action` or a `failure`, not both"),
            (
                "button",
                "disturbance = { signal = \"Speed\", kind = \"stuck\" }",
                "an `action` or a `disturbance`, not both",
            ),
            ("button", "latching = true", "is not `latching`"),
        ] {
            let (said, place) = wrong(kind, more);
            assert!(said.contains(message) && place == "\"reset\"", "{said} at {place}");
        }
        assert_eq!(wrong("button", "signal = \"Seen\"").1, "\"Seen\"", "its signal is one that people write");
        let real =
            "[clients.real]\nkind = \"gateway\"\ngateway = { url = \"tcp://127.0.0.1:1\", handshake = \"frames\" }\n";
        let text = format!(
            "{}{}",
            HEAD.replace("[[panel]]", &format!("{real}[[panel]]")),
            element("button", "action = \"reset\"\nat = [0, 0]")
        );
        let mut file: ScenarioFile = toml::from_str(&text).expect("a scenario");
        crate::structure::expand(&mut file).expect("signals");
        let found = check(&file).expect_err("its program goes on");
        assert!(found.message.contains("client `real`") && &text[found.place.clone()] == "\"reset\"", "{found:?}");
    }

    #[test]
    fn each_fault_is_reported_at_its_place() {
        let wrong = |kind: &str, more: &str| reported(&element(kind, more)).expect_err("wrong");
        let (message, place) = wrong("button", "signal = \"Strat\"\nat = [0, 0]");
        assert_eq!((&*message, &*place), ("the panel has a signal `Strat` that is not declared", "\"Strat\""));
        assert_eq!(
            wrong("button", "signal = \"Speed\"\nat = [0, 0]").0,
            "`Speed` is REAL; a button, a switch and a lamp need BOOL"
        );
        assert!(wrong("selector", "signal = \"Speed\"\nat = [0, 0]").0.contains("needs a signal with `names`"));
        assert!(wrong("switch", "signal = \"Seen\"\nat = [0, 0]").0.contains("is written by the plant"));
        assert!(wrong("button", "signal = \"Start\"\nat = [6, 0]").0.contains("beyond the 6 columns"));
        assert!(wrong("button", "signal = \"Start\"\nat = [4294967295, 0]").0.contains("beyond"));
        assert!(wrong("button", "signal = \"Start\"\nat = [0, 0]\nspan = [0, 1]").0.contains("beyond"));
        assert!(wrong("button", "at = [0, 0]").0.contains("needs a `signal`"));
        assert!(wrong("lamp", "signal = \"Start\"\nsignal_y = \"Start\"\nat = [0, 0]").0.contains("only a joystick"));
        assert!(wrong("alarms", "signal = \"Speed\"\nat = [0, 0]").0.contains("is BOOL"));
        assert!(wrong("emergency-stop", "signal = \"Speed\"\nat = [0, 0]").0.contains("an emergency stop is BOOL"));
        assert!(wrong("alarms", "signal = \"Seen\"\nat = [0, 0]").0.contains("is written by the plant"));
        assert!(wrong("bar", "signal = \"Speed\"\nat = [0, 0]\nmin = 1.0\nmax = 1.0").0.contains("not below"));
        assert!(wrong("lamp", "signal = \"Start\"\nat = [0, 0]\ncolour = \"url(x)\"").0.contains("is not a colour"));
        assert!(wrong("switch", "signal = \"Start\"\nat = [0, 0]\nlatching = true").0.contains("only a button"));
        assert!(
            wrong("slider", "failure = \"wall.leak\"\nat = [0, 0]").0.contains("only a switch, a button and a lamp")
        );
        assert!(wrong("switch", "failure = \"leak\"\nat = [0, 0]").0.contains("`component.mode`"));
        let both = "signal = \"Start\"\nfailure = \"wall.leak\"\nat = [0, 0]";
        assert!(wrong("switch", both).0.contains("not both"));
        let stuck = "disturbance = { signal = \"Speed\", kind = \"stuck\" }\nat = [0, 0]";
        assert!(wrong("slider", stuck).0.contains("only a switch, a button and a lamp"));
        for also in ["signal = \"Start\"", "failure = \"wall.leak\""] {
            assert!(wrong("switch", &format!("{also}\n{stuck}")).0.contains("not both"), "{also}");
        }
        let timed = "disturbance = { signal = \"Speed\", kind = \"stuck\", for = \"1s\" }\nat = [0, 0]";
        assert!(wrong("switch", timed).0.contains("by somebody's hand"));
        let two = element("lamp", "signal = \"Start\"\nat = [0, 0]\nspan = [2, 2]");
        let over = reported(&(two + &element("lamp", "signal = \"Start\"\nat = [1, 1]"))).expect_err("wrong");
        assert!(over.0.contains("lies on the one at column 0, row 0"), "{over:?}");
        for (page, said) in [
            ("{ signal = \"Mode\", value = 1 }", None),
            ("{ signal = \"Mode\", value = 40000 }", Some("`Mode` is INT, which is never 40000")),
            ("{ signal = \"Speed\", value = 1 }", Some("`Speed` is REAL, which is never 1")),
            ("{ signal = \"Seen\", value = 1 }", Some("`Seen` is BOOL, which is never 1")),
            ("{ signal = \"Mood\", value = 1 }", Some("the panel has a signal `Mood` that is not declared")),
        ] {
            let found = reported(&format!("page = {page}\nelement = []")).err().map(|(message, _)| message);
            assert_eq!(found.as_deref(), said, "{page}");
        }
        assert!(
            reported("element = []\n[[panel]]\nname = \"desk\"\nelement = []")
                .expect_err("wrong")
                .0
                .contains("two panels")
        );
    }
}
