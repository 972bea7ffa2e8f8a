//! Scans the built-in room, or one from a file, and prints every look and the score.
use dorsal_scan::{Scan, ScanParams};
use stereo_scenes::Room;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let room = match std::env::args().nth(1) {
        Some(path) => Room::from_toml(&std::fs::read_to_string(path)?)?,
        None => Room::scan(),
    };
    let mut scan = Scan::begin(room, ScanParams::default())?;
    let mut lines = Vec::new();
    while let Some(fixation) = scan.next() {
        let moved = scan.stir();
        let shown = scan.show(&fixation)?;
        let look = scan.perceive(shown, moved)?;
        lines.push(format!("{}: {}", look.number, look.shown.fixation.why));
    }
    lines.push(scan.score()?.to_string());
    std::io::Write::write_all(&mut std::io::stdout(), (lines.join("\n") + "\n").as_bytes())?;
    Ok(())
}
