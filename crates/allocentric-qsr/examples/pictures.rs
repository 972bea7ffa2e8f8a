//! Draws the pictures of the page on the calculus: `cargo run -p allocentric-qsr --example pictures
//! -- docs/pictures`.
//!
//! The colours of the triangle are not drawn by hand: each dot is a place of d, labelled by the
//! library from the signs of its offsets.
#![allow(
    clippy::print_stdout,
    reason = "a program for people says what it wrote"
)]

use std::fmt::Write;
use std::path::PathBuf;

use allocentric_qsr::Orientation;

/// Half the side of a picture.
const HALF: i32 = 150;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    for (name, picture) in [
        ("nine-regions.svg", nine_regions()),
        ("triangle.svg", triangle()),
    ] {
        std::fs::write(folder.join(name), picture)?;
        println!("{}", folder.join(name).display());
    }
    Ok(())
}

fn framed(body: &str) -> String {
    let side = 2 * HALF;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{} {} {side} {side}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n{body}</svg>\n",
        -HALF, -HALF
    )
}

/// A word in the middle of a place, x to the right and y up.
fn word(x: i32, y: i32, text: &str) -> String {
    format!(
        "<text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{text}</text>\n",
        4 - y
    )
}

fn line(from: (i32, i32), to: (i32, i32), style: &str) -> String {
    format!(
        "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"black\" {style}/>\n",
        from.0, -from.1, to.0, -to.1
    )
}

/// Figure 5: the labels of c at b, the way from a to b leading up.
fn nine_regions() -> String {
    let mut body = line((-130, 0), (130, 0), "") + &line((0, -130), (0, 130), "");
    body += "<circle cx=\"0\" cy=\"0\" r=\"4\"/>\n<circle cx=\"0\" cy=\"110\" r=\"4\"/>\n";
    body += &word(12, -14, "b");
    body += &word(12, -114, "a");
    for label in Orientation::ALL {
        let place = label as i32;
        let (x, y) = (85 * (place % 3 - 1), 70 * (1 - place / 3));
        let (x, y) = if label == Orientation::None {
            (-14, 12)
        } else {
            (x, y)
        };
        let beside = if x == 0 { 14 } else { 0 };
        let above = if y == 0 { 10 } else { 0 };
        body += &word(x + beside, y + above, label.short());
    }
    framed(&body)
}

/// The double cross: where d may lie at b (below) and c (above), one colour for each pair of
/// labels.
fn triangle() -> String {
    let mut body = String::new();
    let (b, c) = (-50, 50);
    let step = 8;
    let mut pairs: Vec<(Orientation, Orientation)> = Vec::new();
    for row in -17..=17 {
        for column in -17..=17 {
            // Half a step off the rays, for a dot has no measure there.
            let (x, y) = (column * step + step / 2, row * step + step / 2);
            let at = |from: i32| Orientation::of_offset(y - from, -x);
            let pair = (at(c), at(b));
            let known = pairs.iter().position(|&other| other == pair);
            let colour = known.unwrap_or_else(|| {
                pairs.push(pair);
                pairs.len() - 1
            });
            // Writing to a string cannot fail.
            let _ = writeln!(
                body,
                "<circle cx=\"{x}\" cy=\"{}\" r=\"2.5\" fill=\"hsl({},60%,65%)\"/>",
                -y,
                colour * 60
            );
        }
    }
    body += &line((-HALF, b), (HALF, b), "");
    body += &line((-HALF, c), (HALF, c), "");
    body += &line((0, -HALF), (0, HALF), "");
    let d = (70, 100);
    for (from, to) in [((0, b), (0, c)), ((0, c), d), ((0, b), d)] {
        body += &line(from, to, "stroke-width=\"2.5\"");
    }
    body += &word(-12, b - 12, "b");
    body += &word(-12, c + 10, "c");
    body += &word(d.0 + 12, d.1, "d");
    body += &word(-10, 0, "x");
    body += &word(28, c + 34, "y");
    body += &word(48, 8, "r");
    framed(&body)
}
