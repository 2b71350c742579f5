//! Views and figures: from where the machine is seen, and what is drawn of it beside the bodies of its plants.

use onescan_base::array;
use onescan_plant::Frame;
use toml::Spanned;

use crate::error::Wrong;
use crate::file::ScenarioFile;
use crate::look_file::{FigureFile, FigureShape, ViewFile};
use crate::panel::check_colour;

/// A body for the eye only.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub name: String,
    pub form: FigureForm,
    /// Where it is, in the frame of what it is on.
    pub place: Frame,
    /// The figure or the body that it moves with.
    pub on: Option<String>,
    pub colour: Option<String>,
    /// How much one sees through it, 0 to 1.
    pub transparent: f64,
}

/// The form of a figure; lengths in m, cylinders and tubes along z.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "as of a body")]
pub enum FigureForm {
    Box {
        size_m: [f64; 3],
    },
    /// A cylinder or, with another radius at its upper end, a cone; open at its ends if it is a tube.
    Round {
        radius_m: f64,
        top_radius_m: f64,
        length_m: f64,
        is_open: bool,
    },
    Sphere {
        radius_m: f64,
    },
}

fn at<T>(place: &Spanned<T>, message: String) -> Wrong {
    Wrong { message, place: place.span(), help: None }
}

/// Checks the views.
pub(crate) fn check_views(views: &[ViewFile]) -> Result<(), Wrong> {
    for (index, view) in views.iter().enumerate() {
        let name = view.name.get_ref();
        if name.trim().is_empty() {
            return Err(at(&view.name, "a view needs a name".to_owned()));
        }
        if views[..index].iter().any(|other| other.name.get_ref() == name) {
            return Err(at(&view.name, format!("there are two views `{name}`")));
        }
        if !view.position_m.iter().chain(&view.target_m).all(|length| length.is_finite()) {
            return Err(at(&view.name, format!("view `{name}` is nowhere: its places need numbers")));
        }
        if view.position_m == view.target_m {
            return Err(at(&view.name, format!("view `{name}` looks at the place where it is")));
        }
    }
    Ok(())
}

/// The figures, arrays written out.
pub(crate) fn figures(file: &ScenarioFile) -> Result<Vec<Figure>, Wrong> {
    let mut all: Vec<Figure> = Vec::new();
    for figure in &file.figure {
        for one in written_out(figure)? {
            if all.iter().any(|other| other.name == one.name) {
                return Err(at(&figure.name, format!("there are two figures `{}`", one.name)));
            }
            if let (Some(on), Some(written)) = (&one.on, &figure.on)
                && file.figure.iter().any(|other| other.name.get_ref() == on)
                && !all.iter().any(|other| other.name == *on)
            {
                let help = Some("a figure is written further up than what moves with it".to_owned());
                let message = format!("`{}` is on `{on}`, which comes later", one.name);
                return Err(Wrong { message, place: written.span(), help });
            }
            all.push(one);
        }
    }
    Ok(all)
}

fn written_out(file: &FigureFile) -> Result<Vec<Figure>, Wrong> {
    let name = file.name.get_ref();
    if name.trim().is_empty() {
        return Err(at(&file.name, "a figure needs a name".to_owned()));
    }
    let form = form(file).map_err(|message| at(&file.name, format!("figure `{name}` {message}")))?;
    if let Some(colour) = &file.colour {
        check_colour(colour.get_ref(), colour.span())?;
    }
    if !(0.0..=1.0).contains(&file.transparent) {
        return Err(at(&file.name, format!("figure `{name}` is transparent by {}, not by 0 to 1", file.transparent)));
    }
    let turn = file.turn_about_m.unwrap_or_default();
    if ![file.position_m, file.rpy_deg, file.step_m, turn].as_flattened().iter().all(|number| number.is_finite()) {
        return Err(at(&file.name, format!("figure `{name}` has a place without numbers")));
    }
    let indices = array::indices(name).map_err(|error| at(&file.name, error.to_string()))?;
    let first = Frame::at(file.position_m, file.rpy_deg);
    let figure = |name: String, place: Frame, index: Option<usize>| Figure {
        name,
        form,
        place,
        on: file.on.as_ref().map(|on| index.map_or_else(|| on.get_ref().clone(), |i| array::at_index(on.get_ref(), i))),
        colour: file.colour.as_ref().map(|colour| colour.get_ref().clone()),
        transparent: file.transparent,
    };
    let Some(indices) = indices else { return Ok(vec![figure(name.clone(), first, None)]) };
    let count = indices.clone().count();
    let copy = |(number, index): (usize, usize)| {
        #[expect(clippy::cast_precision_loss, reason = "ten thousand at most")]
        let (k, n) = (number as f64, count as f64);
        let place = match file.turn_about_m {
            Some(centre) => first
                .seen_from(Frame::at(centre.map(|part| -part), [0.0; 3]))
                .seen_from(Frame::at(centre, [0.0, 0.0, 360.0 * k / n])),
            None => first.seen_from(Frame::at(file.step_m.map(|part| part * k), [0.0; 3])),
        };
        figure(array::name_at(name, index), place, Some(index))
    };
    Ok(indices.enumerate().map(copy).collect())
}

/// What the measures make of it, or what is wrong with them.
fn form(file: &FigureFile) -> Result<FigureForm, String> {
    let positive = |key: &str, length: Option<f64>| match length {
        Some(length) if length.is_finite() && length > 0.0 => Ok(length),
        Some(length) => Err(format!("has `{key}` {length}, which is not a length")),
        None => Err(format!("needs `{key}`")),
    };
    let unused = |keys: &[(&str, bool)]| match keys.iter().find(|(_, is_there)| *is_there) {
        Some((key, _)) => Err(format!("has `{key}`, which its shape does not have")),
        None => Ok(()),
    };
    let [size, radius, top, length] =
        [file.size_m.is_some(), file.radius_m.is_some(), file.top_radius_m.is_some(), file.length_m.is_some()];
    match file.shape {
        FigureShape::Box => {
            unused(&[("radius_m", radius), ("top_radius_m", top), ("length_m", length)])?;
            let size_m = file.size_m.ok_or("needs `size_m`")?;
            for length in size_m {
                positive("size_m", Some(length))?;
            }
            Ok(FigureForm::Box { size_m })
        }
        FigureShape::Sphere => {
            unused(&[("size_m", size), ("top_radius_m", top), ("length_m", length)])?;
            Ok(FigureForm::Sphere { radius_m: positive("radius_m", file.radius_m)? })
        }
        FigureShape::Cylinder | FigureShape::Tube => {
            unused(&[("size_m", size)])?;
            let radius_m = positive("radius_m", file.radius_m)?;
            let top_radius_m = match file.top_radius_m {
                Some(top) if top.is_finite() && top >= 0.0 => top,
                Some(top) => return Err(format!("has `top_radius_m` {top}, which is not a length")),
                None => radius_m,
            };
            let (length_m, is_open) = (positive("length_m", file.length_m)?, file.shape == FigureShape::Tube);
            Ok(FigureForm::Round { radius_m, top_radius_m, length_m, is_open })
        }
    }
}
