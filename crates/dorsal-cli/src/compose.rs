use std::io::Write;

use dorsal::allocentric_qsr::{
    Case, DepthReference, DepthSet, Mode, Orientation, OrientationSet, Places, TriangleTable,
    compose as compose_classes, compose_over_base,
};
use serde::Serialize;

use crate::compose_arguments::{ComposeArguments, CompositionCase};
use crate::memory_arguments::Format;
use crate::reference_system::reference_system;
use crate::wrong_call::WrongCall;

/// A composition as data.
#[derive(Serialize)]
struct CompositionRecord<'r> {
    system: &'r str,
    mode: Mode,
    depth: Vec<&'r str>,
    /// Only where the case gives a place.
    #[serde(skip_serializing_if = "Option::is_none")]
    orientation: Option<OrientationSet>,
}

/// `dorsal compose`: one composition.
pub(crate) fn compose(arguments: &ComposeArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let reference = reference_system(&arguments.system)?;
    let mode = arguments.mode.into();
    let first = place(&reference, &arguments.first)?;
    let second = place(&reference, &arguments.second)?;
    let base = arguments
        .base
        .as_deref()
        .map(|base| classes(&reference, base))
        .transpose()?;
    if base.is_some() && arguments.case != CompositionCase::Four {
        return Err(WrongCall("--base belongs to --case 4".to_owned()).into());
    }
    let (depth, orientation) = match mode {
        Mode::Published => {
            if arguments.first.contains('@') || arguments.second.contains('@') {
                let why = "the published calculus composes distances only; leave the labels out";
                return Err(WrongCall(why.to_owned()).into());
            }
            (
                published(&reference, arguments.case, [first, second], base),
                None,
            )
        }
        Mode::Sound => sound(&reference, arguments.case, [first, second], base),
    };
    let record = CompositionRecord {
        system: reference.name(),
        mode,
        depth: reference.labels(depth),
        orientation,
    };
    match arguments.format {
        Format::Json => writeln!(out, "{}", serde_json::to_string(&record)?)?,
        Format::Text if depth.is_empty() => {
            writeln!(out, "nothing is left: no three points of the plane are so")?;
        }
        Format::Text => {
            write!(out, "{{{}}}", record.depth.join(", "))?;
            if let Some(orientation) = orientation {
                write!(out, ", {{{}}}", orientation.labels().join(", "))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}

fn published(
    reference: &DepthReference,
    case: CompositionCase,
    [first, second]: [Places; 2],
    base: Option<DepthSet>,
) -> DepthSet {
    let case = match case {
        CompositionCase::One => Case::One,
        CompositionCase::Two => Case::Two,
        CompositionCase::Three | CompositionCase::Ego => Case::Three,
        CompositionCase::Four => {
            let Some(base) = base else {
                return reference.all();
            };
            let mode = Mode::Published;
            return compose_over_base(reference, mode, base, first.depth, second.depth).depth;
        }
    };
    compose_classes(reference, case, Mode::Published, first.depth, second.depth).depth
}

fn sound(
    reference: &DepthReference,
    case: CompositionCase,
    [first, second]: [Places; 2],
    base: Option<DepthSet>,
) -> (DepthSet, Option<OrientationSet>) {
    let table = TriangleTable::plan(reference);
    let [one, two] = [first, second].map(|place| (place.orientation, place.depth));
    match case {
        CompositionCase::One => {
            let places = table.case1(one, two).places();
            (places.depth, Some(places.orientation))
        }
        CompositionCase::Two => (table.case2(one, two), None),
        CompositionCase::Three => (
            table.case3(first.depth, second.depth, second.orientation),
            None,
        ),
        CompositionCase::Four => (
            base.map_or(reference.all(), |base| table.case4(base, one, two)),
            None,
        ),
        CompositionCase::Ego => {
            let places = table
                .between(first.depth, second.depth, second.orientation)
                .places();
            (places.depth, Some(places.orientation))
        }
    }
}

/// `CLASSES[@LABELS]` in the words of a reference system.
fn place(reference: &DepthReference, text: &str) -> Result<Places, WrongCall> {
    let (depths, labels) = text.split_once('@').unwrap_or((text, ""));
    let named = |label: &str| {
        Orientation::named(label).ok_or_else(|| {
            WrongCall(format!(
                "`{label}` of `{text}` is no orientation; they are fl sf fr l n r bl sb br"
            ))
        })
    };
    let orientation = if labels.is_empty() {
        OrientationSet::ALL
    } else {
        labels.split(',').map(named).collect::<Result<_, _>>()?
    };
    Ok(Places {
        depth: classes(reference, depths)?,
        orientation,
    })
}

fn classes(reference: &DepthReference, text: &str) -> Result<DepthSet, WrongCall> {
    let class = |label: &str| {
        reference.class_named(label).ok_or_else(|| {
            WrongCall(format!(
                "`{label}` is no distance class of {}; they are {}",
                reference.name(),
                reference.labels(reference.all()).join(" ")
            ))
        })
    };
    text.split(',').map(class).collect()
}
