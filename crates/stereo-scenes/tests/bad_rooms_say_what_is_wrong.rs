//! A room that cannot be gets a sentence that names the thing.
#![allow(
    clippy::unwrap_used,
    reason = "a law that cannot be tested fails its test"
)]

use stereo_scenes::{BadRoom, Exposure, Gaze, NoView, Room, render};

const ROOM: &str = r#"
size_m = [3.0, 3.0, 2.4]
lamp_m = [1.5, 1.5, 2.2]
[head]
position_m = [1.5, 0.4, 1.2]
fixation_m = [1.5, 1.4, 1.0]
[[object]]
name = "ball"
shape.sphere = { centre_m = [1.5, 1.5, 1.0], radius_m = 0.1 }
[[object]]
name = "cup"
shape.cylinder = { base_m = [1.2, 1.5, 0.0], radius_m = 0.1, height_m = 0.2 }
"#;

fn complaint(from: &str, to: &str) -> String {
    assert!(ROOM.contains(from));
    Room::from_toml(&ROOM.replace(from, to))
        .unwrap_err()
        .to_string()
}

#[test]
fn rooms_that_come_with_the_crate_are_rooms() {
    assert_eq!(Room::demo().objects().len(), 8);
    assert_eq!(Room::shelf().objects().len(), 6);
    let room = Room::from_toml(ROOM).unwrap();
    let names: Vec<_> = room.names().map(|(l, n)| (l.0.get(), n)).collect();
    assert_eq!(names, [(1, "ball"), (2, "cup")]);
}

#[test]
fn complaints_name_the_thing() {
    let unknown = complaint("radius_m = 0.1 }", "radius_m = 0.1, colour = 3 }");
    assert!(
        unknown.contains("keys in table: colour") && unknown.contains("line 9"),
        "{unknown}"
    );
    let shape = complaint("shape.sphere", "shape.cone");
    assert!(
        shape.contains("cone") && shape.contains("cylinder"),
        "{shape}"
    );
    let negative = complaint(
        "[1.5, 1.5, 1.0], radius_m = 0.1",
        "[1.5, 1.5, 1.0], radius_m = -0.1",
    );
    assert!(
        negative.contains("`ball`") && negative.contains("-0.1 m"),
        "{negative}"
    );
    let same = complaint("\"cup\"", "\"ball\"");
    assert!(same.contains("called `ball`"), "{same}");
    let outside = complaint("[1.2, 1.5, 0.0]", "[0.05, 1.5, 0.0]");
    assert!(
        outside.contains("`cup`") && outside.contains("beyond the walls"),
        "{outside}"
    );
    let nowhere = complaint("[1.5, 1.5, 1.0], r", "[nan, 1.5, 1.0], r");
    assert!(nowhere.contains("`ball`"), "{nowhere}");
    let behind = complaint("[1.5, 1.4, 1.0]", "[1.5, 0.2, 1.0]");
    assert!(behind.contains("not in front"), "{behind}");
    let nameless = complaint("\"cup\"", "\" \"");
    assert!(nameless.contains("number 2"), "{nameless}");
    let paint = complaint(
        "name = \"ball\"",
        "name = \"ball\"\ntexture.colour = [2, 0, 0]",
    );
    assert!(paint.contains("texture of `ball`"), "{paint}");
    assert!(matches!(
        Room::from_toml("size_m = 3"),
        Err(BadRoom::Text(_))
    ));
}

#[test]
fn an_eye_in_a_wall_sees_nothing() {
    let room = Room::from_toml(ROOM).unwrap();
    let gaze = room.gaze().unwrap();
    let inside_wall = Gaze::new([0.1, 1.0, 1.0], 0.0, gaze.size(), gaze.rig()).unwrap();
    let seen = render(&room, &inside_wall, Exposure::default());
    assert!(matches!(seen, Err(NoView::Outside { .. })));
    for samples in [0, 17] {
        let exposure = Exposure {
            samples,
            ..Exposure::default()
        };
        assert!(matches!(
            render(&room, &gaze, exposure),
            Err(NoView::Samples(_))
        ));
    }
}
