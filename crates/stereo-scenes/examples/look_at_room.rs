//! Renders a room and writes the left and right image as binary PPM files.
//!
//! `cargo run --release -p stereo-scenes --example look_at_room -- OUT_FOLDER [ROOM.toml]`
use std::{env, error::Error, fs, io::Write as _, path::Path, time::Instant};

use stereo_scenes::{Exposure, Room, render};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args_os().skip(1);
    let folder = arguments
        .next()
        .ok_or("which folder shall the images go to?")?;
    let room = match arguments.next() {
        Some(path) => Room::from_toml(&fs::read_to_string(path)?)?,
        None => Room::demo(),
    };
    fs::create_dir_all(&folder)?;

    let start = Instant::now();
    let view = render(&room, &room.gaze()?, Exposure::default())?;
    let mut report = format!("rendered in {:.2} s\n", start.elapsed().as_secs_f64());
    for object in &view.truth.objects {
        report += &format!(
            "{:14} {:6} px, {:6} seen by both eyes, at {:.3?}, depth {:.3?}\n",
            object.name,
            object.pixels,
            object.binocular_pixels,
            object.surface.map(|surface| surface.point_m),
            object.surface.map(|surface| surface.depth_m),
        );
    }
    std::io::stdout().write_all(report.as_bytes())?;

    for (name, colour) in [
        ("left.ppm", &view.colour.left),
        ("right.ppm", &view.colour.right),
    ] {
        let (height, width, _) = colour.dim();
        let mut file = format!("P6\n{width} {height}\n255\n").into_bytes();
        // The cast saturates, so that a sample beyond white stays white.
        file.extend(colour.iter().map(|sample| (sample * 255.0).round() as u8));
        fs::write(Path::new(&folder).join(name), file)?;
    }
    Ok(())
}
