use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use allocentric_qsr::Orientation;
use anyhow::Context as _;
use clap::Args;

/// Half the side of a picture.
const HALF: i32 = 150;

/// Draws the pictures of the page on the calculus.
///
/// The colours are not drawn by hand: each dot is a place of d, labelled by the library from the signs
/// of its offsets.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  cargo xtask calculus-pictures --out docs/pictures")]
pub(crate) struct Options {
    /// Folder for nine-regions.svg, triangle.svg and derivation.svg
    #[arg(long, value_name = "DIR", default_value = "docs/pictures")]
    out: PathBuf,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    fs::create_dir_all(&options.out)
        .with_context(|| format!("the folder {} cannot be made", options.out.display()))?;
    for (name, picture) in [
        ("nine-regions.svg", nine_regions()),
        ("triangle.svg", triangle()),
        ("derivation.svg", derivation()),
    ] {
        let path = options.out.join(name);
        stereo_formats::replace(&path, picture.as_bytes())
            .with_context(|| format!("{} cannot be written", path.display()))?;
        println!("{}", path.display());
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

/// The derivation of the page: d behind c and still before b, to the left; where it may lie, the
/// circle of a fixed y about c, and the two ends of its arc in that region.
fn derivation() -> String {
    let (b, c) = (-70, 60);
    let (x, y) = (c - b, 90);
    let mut body = String::new();
    let step = 8;
    for row in -17..=17 {
        for column in -17..=0 {
            let (right, up) = (column * step - step / 2, row * step + step / 2);
            let at = |from: i32| Orientation::of_offset(up - from, -right);
            if (at(c), at(b)) == (Orientation::BackLeft, Orientation::FrontLeft) {
                // Writing to a string cannot fail.
                let _ = writeln!(
                    body,
                    "<circle cx=\"{right}\" cy=\"{}\" r=\"2.5\" fill=\"hsl(120,60%,70%)\"/>",
                    -up
                );
            }
        }
    }
    body += &line((-HALF, b), (HALF, b), "");
    body += &line((-HALF, c), (HALF, c), "");
    body += &line((0, -HALF), (0, HALF), "");
    // The quarter circle from the ray l of c, where r is greatest, to the line, where r is x - y.
    let _ = writeln!(
        body,
        "<path d=\"M {} {} A {y} {y} 0 0 0 0 {}\" fill=\"none\" stroke=\"black\" \
         stroke-dasharray=\"4 3\" stroke-width=\"1.5\"/>",
        -y,
        -c,
        -(c - y)
    );
    for (end, style) in [
        ((-y, c), "stroke-width=\"2.5\""),
        ((0, c - y), "stroke-width=\"5\""),
    ] {
        body += &line((0, b), end, style);
    }
    body += &line((0, c), (-y, c), "stroke-width=\"2.5\"");
    let _ = writeln!(body, "<circle cx=\"0\" cy=\"{}\" r=\"4\"/>", -b);
    let _ = writeln!(body, "<circle cx=\"0\" cy=\"{}\" r=\"4\"/>", -c);
    body += &word(14, b - 12, "b");
    body += &word(14, c + 10, "c");
    body += &word(-y / 2, c + 10, "y");
    body += &word(62, b + x / 2, "x = |bc|");
    body += &word(-82, -14, "r &lt; root(x\u{b2} + y\u{b2})");
    body += &word(46, (b + c - y) / 2, "r &gt; x - y");
    framed(&body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_whole() {
        for picture in [nine_regions(), triangle(), derivation()] {
            assert!(picture.starts_with("<svg") && picture.ends_with("</svg>\n"));
        }
        // Six open regions, six colours.
        let triangle = triangle();
        let colours = (0..6).filter(|k| triangle.contains(&format!("hsl({},", k * 60)));
        assert_eq!(colours.count(), 6);
    }
}
