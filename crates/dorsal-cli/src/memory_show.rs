use std::io::Write;

use dorsal::allocentric_qsr::{Life, SceneMemory};

use crate::memory_arguments::ShowForm;
use crate::object_table::place_words;
use crate::text_table::TextTable;

/// `dorsal memory show`: all that is remembered.
pub(crate) fn show(
    memory: &SceneMemory,
    form: ShowForm,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    match form {
        ShowForm::Text => write!(out, "{}", text(memory))?,
        ShowForm::Json => writeln!(out, "{}", memory.to_json())?,
        ShowForm::Dot => write!(out, "{}", memory.to_dot())?,
    }
    Ok(())
}

fn text(memory: &SceneMemory) -> String {
    let robot = memory.robot();
    let pose = robot.pose();
    let mut text = format!(
        "{} looks, the last at {} ms; map frame {}, the robot at ({:.3}, {:.3}) m, turned left by \
         {:.1} degrees; distances by {}\n\n",
        memory.looks(),
        memory.time_ms(),
        memory.frame(),
        pose.x_m(),
        pose.z_m(),
        pose.heading_rad().to_degrees(),
        memory.reference().name(),
    );
    let mut table = TextTable::new([
        "object",
        "life",
        ">last look",
        ">sightings",
        ">right m",
        ">ahead m",
        ">sigma m",
        "for the robot",
    ]);
    for (name, kept) in memory.objects() {
        let place = memory.from_robot(name);
        let number = |metres: Option<f64>| metres.map_or("-".to_owned(), |m| format!("{m:.3}"));
        let sigma = place.map(|place| {
            let [[rr, _], [_, ff]] = place.covariance_m2;
            (rr + ff).sqrt()
        });
        let words = memory.place_from(robot, name);
        let nowhere = if kept.life == Life::Removed {
            "gone"
        } else {
            "in another map frame"
        };
        table.line([
            name.to_string(),
            kept.life.to_string(),
            kept.last_look.to_string(),
            kept.sightings.to_string(),
            number(place.map(|place| place.right_m)),
            number(place.map(|place| place.forward_m)),
            number(sigma),
            words.map_or_else(
                || nowhere.to_owned(),
                |place| place_words(place.read, memory.reference()),
            ),
        ]);
    }
    text += &table.to_string();
    if !memory.facts().is_empty() {
        text += "\ntold:\n";
        for fact in memory.facts() {
            text += &format!("  {}\n", memory.words(fact));
        }
    }
    text
}
