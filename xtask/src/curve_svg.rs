//! Curves as a scalable picture: several small diagrams on one sheet, one legend for all.

use std::fmt::Write;

/// One diagram.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Diagram {
    /// What is drawn along x.
    pub(crate) title: String,
    /// One list of points a curve, in the order of the legend; an empty one draws nothing.
    pub(crate) curves: Vec<Vec<(f64, f64)>>,
}

/// The sheet: what is drawn along y, the curves' names, the diagrams.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sheet {
    /// What is drawn along y in every diagram.
    pub(crate) title: String,
    /// Names of the curves.
    pub(crate) names: Vec<String>,
    /// The diagrams, row by row.
    pub(crate) diagrams: Vec<Diagram>,
}

const COLUMNS: usize = 3;
const WIDTH: f64 = 250.0;
const HEIGHT: f64 = 170.0;
/// Room about the axes of a diagram: left, top, right, bottom.
const ROOM: [f64; 4] = [38.0, 26.0, 12.0, 22.0];
const HEAD: f64 = 44.0;
/// Colours that colour-blind eyes tell apart (Okabe and Ito), each with its own dashes.
const PENS: [(&str, &str); 5] = [
    ("#0072b2", "none"),
    ("#d55e00", "6 3"),
    ("#009e73", "2 2"),
    ("#cc79a7", "8 2 2 2"),
    ("#000000", "1 3"),
];

/// The sheet as an SVG file. Every diagram has the axes that its own points need; y holds 0.
pub(crate) fn encode(sheet: &Sheet) -> String {
    let rows = sheet.diagrams.len().div_ceil(COLUMNS);
    let (width, height) = (COLUMNS as f64 * WIDTH, HEAD + rows as f64 * HEIGHT);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n\
         <text x=\"12\" y=\"18\" font-size=\"14\">{}</text>\n",
        escaped(&sheet.title)
    );
    for (place, name) in sheet.names.iter().enumerate() {
        let (colour, dashes) = PENS[place % PENS.len()];
        let x = 12.0 + 110.0 * place as f64;
        // Writing to a string does not fail, here and below.
        let _ = writeln!(
            svg,
            "<line x1=\"{x}\" y1=\"34\" x2=\"{}\" y2=\"34\" stroke=\"{colour}\" \
             stroke-width=\"2\" stroke-dasharray=\"{dashes}\"/>\
             <text x=\"{}\" y=\"38\">{}</text>",
            x + 26.0,
            x + 32.0,
            escaped(name)
        );
    }
    for (place, diagram) in sheet.diagrams.iter().enumerate() {
        let left = (place % COLUMNS) as f64 * WIDTH;
        let top = HEAD + (place / COLUMNS) as f64 * HEIGHT;
        draw(&mut svg, diagram, (left, top));
    }
    svg.push_str("</svg>\n");
    svg
}

fn draw(svg: &mut String, diagram: &Diagram, (left, top): (f64, f64)) {
    let [room_left, room_top, room_right, room_bottom] = ROOM;
    let (x0, x1) = (left + room_left, left + WIDTH - room_right);
    let (y0, y1) = (top + HEIGHT - room_bottom, top + room_top);
    let _ = writeln!(
        svg,
        "<text x=\"{x0}\" y=\"{}\">{}</text>",
        y1 - 8.0,
        escaped(&diagram.title)
    );
    let points = || diagram.curves.iter().flatten();
    let Some(&(first, _)) = points().next() else {
        return;
    };
    let least = points().map(|p| p.0).fold(first, f64::min);
    let most = points().map(|p| p.0).fold(first, f64::max);
    let (low, high) = points().fold((0.0, 0.0), |(low, high): (f64, f64), p| {
        (low.min(p.1), high.max(p.1))
    });
    let step_y = round_step((high - low) / 4.0);
    let (low, high) = ((low / step_y).floor(), (high / step_y).ceil().max(1.0));
    let step_x = round_step((most - least) / 5.0);
    let across = |x: f64| x0 + (x - least) / (most - least).max(f64::MIN_POSITIVE) * (x1 - x0);
    let up = |y: f64| y0 - (y / step_y - low) / (high - low) * (y0 - y1);

    for tick in low as i64..=high as i64 {
        let value = tick as f64 * step_y;
        let y = up(value);
        let _ = writeln!(
            svg,
            "<line x1=\"{x0}\" y1=\"{y:.1}\" x2=\"{x1}\" y2=\"{y:.1}\" stroke=\"#dddddd\"/>\
             <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            x0 - 4.0,
            y + 4.0,
            number(value, step_y)
        );
    }
    let first = (least / step_x).ceil() as i64;
    let last = (most / step_x + 1e-9).floor() as i64;
    for tick in first..=last {
        let value = tick as f64 * step_x;
        let x = across(value);
        let _ = writeln!(
            svg,
            "<line x1=\"{x:.1}\" y1=\"{y0}\" x2=\"{x:.1}\" y2=\"{}\" stroke=\"#888888\"/>\
             <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            y0 + 3.0,
            y0 + 14.0,
            number(value, step_x)
        );
    }
    for (place, curve) in diagram.curves.iter().enumerate().rev() {
        let (colour, dashes) = PENS[place % PENS.len()];
        let places: Vec<String> = curve
            .iter()
            .map(|&(x, y)| format!("{:.1},{:.1}", across(x), up(y)))
            .collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" \
             stroke-dasharray=\"{dashes}\"/>",
            places.join(" ")
        );
    }
    let _ = writeln!(
        svg,
        "<path d=\"M{x0} {y1}V{y0}H{x1}\" fill=\"none\" stroke=\"#888888\"/>"
    );
}

/// The least of 1, 2 and 5 times a power of ten that is not below a number; 1 for none.
fn round_step(at_least: f64) -> f64 {
    if !(at_least > 0.0 && at_least.is_finite()) {
        return 1.0;
    }
    let power = 10f64.powf(at_least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= at_least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// A multiple of a step, with the decimals that the step has.
fn number(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    // Added to zero, so that no label reads -0.
    format!("{:.decimals$}", value + 0.0)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_holds_its_curves() {
        let svg = encode(&Sheet {
            title: "error & more, px".to_owned(),
            names: vec!["ours".to_owned(), "theirs".to_owned()],
            diagrams: vec![
                Diagram {
                    title: "roll".to_owned(),
                    curves: vec![vec![(0.0, 0.2), (2.0, 0.4)], Vec::new()],
                },
                Diagram {
                    title: "nothing".to_owned(),
                    curves: Vec::new(),
                },
            ],
        });
        assert!(svg.contains("error &amp; more"));
        assert_eq!(svg.matches("<polyline").count(), 2);
        // The curve begins at the left axis, at the middle of a diagram that ends at 0.4.
        assert!(svg.contains("points=\"38.0,131.0 238.0,70.0\""), "{svg}");
    }

    #[test]
    fn steps_are_round() {
        for (at_least, step) in [
            (0.09, 0.1),
            (0.1, 0.1),
            (0.11, 0.2),
            (3.0, 5.0),
            (7.0, 10.0),
        ] {
            assert!((round_step(at_least) - step).abs() < 1e-12, "{at_least}");
        }
        assert_eq!(round_step(0.0), 1.0);
        assert_eq!(number(0.30000000000000004, 0.1), "0.3");
        assert_eq!(number(-0.0, 2.0), "0");
    }
}
