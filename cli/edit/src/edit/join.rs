//! Two ends put together, or one let go: which changes that takes.

use schemars::JsonSchema;
use serde::Deserialize;

use super::change::{Edit, Given};
use super::ends::{End, Hand};
use super::error::EditError;

/// What a line is drawn to.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(untagged, deny_unknown_fields)]
pub enum Tip {
    /// An end of a client.
    End {
        /// The client.
        client: String,
        /// What it is there.
        at: String,
    },
    /// A signal.
    Signal {
        /// Its name.
        signal: String,
    },
}

/// A signal of the session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: String,
    /// Who writes it.
    pub writer: String,
}

/// What is known of a tip.
enum Found<'f> {
    End(&'f End),
    Line(&'f Line),
}

impl Found<'_> {
    /// The signal that it is or has.
    fn signal(&self) -> Option<&str> {
        match self {
            Self::End(end) => end.signals.first().map(String::as_str),
            Self::Line(line) => Some(&line.name),
        }
    }

    fn name(&self) -> &str {
        match self {
            Self::End(end) => &end.at,
            Self::Line(line) => &line.name,
        }
    }
}

fn find<'f>(ends: &'f [End], lines: &'f [Line], tip: &Tip) -> Result<Found<'f>, EditError> {
    let (found, name) = match tip {
        Tip::End { client, at } => {
            let end = ends.iter().find(|end| end.client == *client && end.at == *at);
            (end.map(Found::End), at)
        }
        Tip::Signal { signal } => (lines.iter().find(|line| line.name == *signal).map(Found::Line), signal),
    };
    let missing =
        || EditError::Missing { what: "end".to_owned(), name: name.clone(), file: "the wiring".to_owned(), near: None };
    found.ok_or_else(missing)
}

/// The changes by which two tips have one signal.
///
/// # Errors
/// They cannot have one: both write, nobody does, or their types differ.
pub fn join(ends: &[End], lines: &[Line], one: &Tip, other: &Tip) -> Result<Vec<Edit>, EditError> {
    let (one, other) = (find(ends, lines, one)?, find(ends, lines, other)?);
    match (&one, &other) {
        (Found::Line(one), Found::Line(other)) => Err(EditError::Unlike(format!(
            "`{}` and `{}` are two signals: draw to an end of a client",
            one.name, other.name
        ))),
        (Found::Line(line), Found::End(end)) | (Found::End(end), Found::Line(line)) => attach(end, line),
        (Found::End(one), Found::End(other)) if one.client == other.client => Err(EditError::Unlike(format!(
            "`{}` and `{}` are both of `{}`: signals go from one client to another",
            one.at, other.at, one.client
        ))),
        (Found::End(first), Found::End(second)) => {
            let line_of = |end: &Found<'_>| end.signal().and_then(|name| lines.iter().find(|line| line.name == name));
            match (line_of(&one), line_of(&other)) {
                (Some(line), Some(same)) if line == same => Err(EditError::Unlike(format!(
                    "`{}` and `{}` are connected already, by `{}`",
                    one.name(),
                    other.name(),
                    line.name
                ))),
                // the reader goes over to the writer's signal
                (Some(line), Some(_)) if first.gives => attach(second, line),
                (_, Some(line)) => attach(first, line),
                (Some(line), None) => attach(second, line),
                (None, None) => new_signal(first, second),
            }
        }
    }
}

/// An end takes part in a signal.
fn attach(end: &End, line: &Line) -> Result<Vec<Edit>, EditError> {
    let Line { name, ty, writer } = line;
    if end.signals.contains(name) {
        return Err(EditError::Unlike(format!("`{}` has `{name}` already", end.at)));
    }
    if end.ty != *ty {
        return Err(EditError::Unlike(format!("`{name}` is {ty}, `{}` is {}", end.at, end.ty)));
    }
    if end.gives && *writer != end.client {
        return Err(EditError::Unlike(format!(
            "`{name}` is written by `{writer}`, and `{}` would write it, too",
            end.at
        )));
    }
    if !end.gives && *writer == end.client {
        return Err(EditError::Unlike(format!(
            "`{name}` is written by `{writer}` itself: `{}` reads what others write",
            end.at
        )));
    }
    written(end, name).map(|edit| vec![edit])
}

/// The line that gives an end its signal.
fn written(end: &End, signal: &str) -> Result<Edit, EditError> {
    match &end.hand {
        Hand::Key { scene, sort, name, key } => Ok(Edit::Set {
            scene: scene.clone(),
            sort: *sort,
            name: name.clone(),
            key: key.clone(),
            value: Some(Given::Text(signal.to_owned())),
        }),
        Hand::Variable { path } => {
            Ok(Edit::Connect { client: end.client.clone(), signal: signal.to_owned(), variable: path.clone() })
        }
        Hand::Fixed => Err(fixed(end)),
    }
}

fn fixed(end: &End) -> EditError {
    EditError::Unlike(format!("`{}` is written together with others: change its table by hand", end.at))
}

/// A signal of its own for two ends that have none, called as the variable is.
fn new_signal(one: &End, other: &End) -> Result<Vec<Edit>, EditError> {
    let (giver, taker) = match (one.gives, other.gives) {
        (true, false) => (one, other),
        (false, true) => (other, one),
        (true, true) => {
            return Err(EditError::Unlike(format!("`{}` and `{}` both write", one.at, other.at)));
        }
        (false, false) => {
            return Err(EditError::Unlike(format!(
                "`{}` and `{}` both read: nobody would write the signal",
                one.at, other.at
            )));
        }
    };
    if giver.ty != taker.ty {
        let (at, ty) = (&giver.at, &giver.ty);
        return Err(EditError::Unlike(format!("`{at}` is {ty}, `{}` is {}", taker.at, taker.ty)));
    }
    let own = |end: &End| match &end.hand {
        Hand::Variable { path } => path.rsplit('.').next().map(str::to_owned),
        Hand::Key { .. } | Hand::Fixed => None,
    };
    let signal = own(giver).or_else(|| own(taker)).unwrap_or_else(|| giver.at.replace('.', "_"));
    let declare = Edit::Declare {
        signal: signal.clone(),
        ty: giver.ty.clone(),
        writer: giver.client.clone(),
        unit: None,
        about: None,
    };
    let mut edits = vec![declare];
    // a variable of the signal's name is found by it
    for end in [giver, taker].into_iter().filter(|end| own(end).as_ref() != Some(&signal)) {
        edits.push(written(end, &signal)?);
    }
    Ok(edits)
}

/// The changes by which an end has its signal no more.
///
/// # Errors
/// It has none, or what says so cannot be changed here.
pub fn part(ends: &[End], lines: &[Line], tip: &Tip) -> Result<Vec<Edit>, EditError> {
    let end = match find(ends, lines, tip)? {
        Found::End(end) => end,
        Found::Line(line) => return Ok(vec![Edit::Withdraw { signal: line.name.clone() }]),
    };
    let Some(signal) = end.signals.first() else {
        return Err(EditError::Unlike(format!("`{}` is connected to nothing", end.at)));
    };
    match &end.hand {
        Hand::Key { scene, sort, name, key } => {
            let (scene, sort, name, key) = (scene.clone(), *sort, name.clone(), key.clone());
            Ok(vec![Edit::Set { scene, sort, name, key, value: None }])
        }
        Hand::Variable { .. } => Ok(vec![Edit::Disconnect { client: end.client.clone(), signal: signal.clone() }]),
        Hand::Fixed => Err(fixed(end)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::change::Sort;
    use super::*;

    fn variable(at: &str, ty: &str, gives: bool, signals: &[&str]) -> End {
        End {
            client: "plc".into(),
            at: at.into(),
            ty: ty.into(),
            gives,
            signals: signals.iter().map(|signal| (*signal).to_owned()).collect(),
            hand: Hand::Variable { path: at.into() },
        }
    }

    fn port(name: &str, key: &str, ty: &str, gives: bool, signals: &[&str]) -> End {
        let hand = Hand::Key {
            scene: "plant.toml".into(),
            sort: Sort::Component,
            name: name.into(),
            key: format!("{key}_signal"),
        };
        End { client: "plant".into(), at: format!("{name}.{key}"), hand, ..variable("", ty, gives, signals) }
    }

    fn tip(end: &End) -> Tip {
        Tip::End { client: end.client.clone(), at: end.at.clone() }
    }

    fn line(name: &str, ty: &str, writer: &str) -> Line {
        Line { name: name.into(), ty: ty.into(), writer: writer.into() }
    }

    fn said(outcome: Result<Vec<Edit>, EditError>) -> String {
        match outcome {
            Ok(edits) => edits.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
            Err(error) => format!("refused: {error}"),
        }
    }

    #[test]
    fn what_two_ends_take_depends_on_what_they_have() {
        let lines = [line("Box_There", "BOOL", "plant"), line("Push", "BOOL", "plc"), line("Way", "LREAL", "plant")];
        let ends = [
            port("barrier", "detected", "BOOL", true, &["Box_There"]),
            variable("Main.Box_Seen", "BOOL", false, &[]),
            variable("Main.Push", "BOOL", true, &["Push"]),
            port("cylinder", "extend", "BOOL", false, &[]),
            port("switch", "pressed", "BOOL", true, &[]),
            port("cylinder", "position_m", "LREAL", true, &["Way"]),
            variable("Main.Go", "BOOL", true, &[]),
        ];
        let [barrier, seen, push, extend, switch, way, go] = &ends;
        let pairs = [
            (barrier, seen),
            (seen, barrier),
            (push, extend),
            (switch, seen),
            (go, extend),
            (switch, push),
            (extend, seen),
            (way, seen),
            (barrier, barrier),
        ];
        let all: Vec<_> = pairs.iter().map(|(one, other)| said(join(&ends, &lines, &tip(one), &tip(other)))).collect();
        assert_eq!(
            all,
            [
                "connect Box_There with Main.Box_Seen",
                "connect Box_There with Main.Box_Seen",
                "set cylinder.extend_signal to \"Push\"",
                "declare Box_Seen; set switch.pressed_signal to \"Box_Seen\"",
                "declare Go; set cylinder.extend_signal to \"Go\"",
                "refused: `Push` is written by `plc`, and `switch.pressed` would write it, too",
                "refused: `cylinder.extend` and `Main.Box_Seen` both read: nobody would write the signal",
                "refused: `Way` is LREAL, `Main.Box_Seen` is BOOL",
                "refused: `barrier.detected` and `barrier.detected` are both of `plant`: signals go from one client to another",
            ]
        );
        let signal = Tip::Signal { signal: "Box_There".into() };
        assert_eq!(said(join(&ends, &lines, &signal, &tip(seen))), "connect Box_There with Main.Box_Seen");
        assert_eq!(said(part(&ends, &lines, &tip(barrier))), "take barrier.detected_signal away");
        assert_eq!(said(part(&ends, &lines, &tip(push))), "disconnect Push");
        assert_eq!(said(part(&ends, &lines, &tip(seen))), "refused: `Main.Box_Seen` is connected to nothing");
    }
}
