use std::iter::once;

use dorsal::allocentric_qsr::{DepthReference, QualitativeScene};

use crate::text_table::TextTable;

/// The places of the objects at one another, as a square: each cell places the object of its
/// column at the object of its row.
pub(crate) fn relation_table(scene: &QualitativeScene) -> String {
    let reference = scene.reference();
    let names: Vec<_> = scene.places().map(|place| place.object.clone()).collect();
    let numbers: Vec<String> = (1..=names.len()).map(|number| number.to_string()).collect();
    let mut table = TextTable::new(once("").chain(numbers.iter().map(String::as_str)));
    for (number, from) in numbers.iter().zip(&names) {
        let cells = names.iter().map(|to| {
            let read = scene.relation(from, to).and_then(|relation| relation.read);
            read.map_or_else(
                || "-".to_owned(),
                |place| {
                    format!(
                        "{} {}",
                        reference.short(place.depth),
                        place.orientation.short()
                    )
                },
            )
        });
        table.line(once(format!("{number} {from}")).chain(cells));
    }
    format!(
        "What is where: a cell places the object of its column at the object of its row, as the \
         observer\nsees it (f beyond, b before, l and r to the left and right of the line of \
         sight).\n{table}{}",
        legend(reference)
    )
}

/// What the short labels of the distances mean.
fn legend(reference: &DepthReference) -> String {
    let classes = reference.classes();
    let ends = classes.iter().skip(1).map(Some).chain(once(None));
    let spans = classes.iter().zip(ends).map(|(class, end)| {
        let begin = f64::from(class.from_mm) / 1000.0;
        let name = class.name.replace('_', " ");
        end.map_or_else(
            || format!("{} {name} (from {begin} m)", class.short),
            |end| {
                format!(
                    "{} {name} (to {} m)",
                    class.short,
                    f64::from(end.from_mm) / 1000.0
                )
            },
        )
    });
    let spans: Vec<String> = spans.collect();
    format!("distances: {}\n", spans.join(", "))
}
