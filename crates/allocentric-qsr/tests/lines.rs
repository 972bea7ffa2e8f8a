//! A memory that is fed line by line.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use allocentric_qsr::{DepthReference, Life, MemoryParams, MemoryReply, SceneMemory};
use proptest::prelude::*;

fn memory() -> SceneMemory {
    SceneMemory::new(&DepthReference::robot_120(), MemoryParams::default()).unwrap()
}

fn look(time_ms: u64, seen: &str) -> String {
    format!(
        r#"{{"look":{{"time_ms":{time_ms},"pose":{{"x_m":0,"z_m":0,"heading_rad":0}},"seen":[{seen}],"view":{{"half_rad":0.6,"reach_m":2.5}}}}}}"#
    )
}

fn seen(object: &str, distance_m: f64, bearing_rad: f64) -> String {
    format!(
        r#"{{"object":"{object}","distance_m":{distance_m},"bearing_rad":{bearing_rad},"sigma_distance_m":0.01,"sigma_bearing_rad":0.005,"radius_mm":40}}"#
    )
}

#[test]
fn lines_go_in_and_out() {
    let mut memory = memory();
    let both = format!("{},{}", seen("cup", 0.8, 1.6), seen("box", 0.9, 1.2));
    let reply = |memory: &mut SceneMemory, line: &str| {
        serde_json::to_string(&memory.take_line(line)).unwrap()
    };
    let appeared = r#"{"changes":[{"change":"appeared","object":"cup"},{"change":"appeared","object":"box"}]}"#;
    assert_eq!(reply(&mut memory, &look(10, &both)), appeared);
    reply(&mut memory, &look(20, &both));
    let answer = r#"{"answer":{"answer":"objects","certain":["box","cup"],"possible":[]}}"#;
    assert_eq!(reply(&mut memory, r#"{"ask":"within c of robot"}"#), answer);
    let told = r#"{"changes":[{"change":"told","fact":"lamp within vc of cup"}]}"#;
    assert_eq!(
        reply(&mut memory, r#"{"tell":"lamp within vc of cup"}"#),
        told
    );
    let gone = r#"{"changes":[{"change":"retracted","fact":"lamp within vc of cup"}]}"#;
    assert_eq!(
        reply(&mut memory, r#"{"retract":"lamp within vc of cup"}"#),
        gone
    );
    // The view says that the cup is gone.
    for k in 3..6 {
        reply(&mut memory, &look(10 * k, &seen("box", 0.9, 1.2)));
    }
    assert_eq!(memory.object(&"cup".into()).unwrap().life, Life::Missing);
    let before = memory.clone();
    for line in [
        "",
        "{",
        r#"{"sing":"a song"}"#,
        r#"{"ask":"where ghost"}"#,
        r#"{"ask":"why"}"#,
        r#"{"tell":"cup far away"}"#,
        r#"{"retract":"cup within vc of box"}"#,
        r#"{"look":{"time_ms":99,"pose":{"x_m":1e99,"z_m":0,"heading_rad":0},"seen":[]}}"#,
        &look(1, ""),
        &look(99, &seen("cup", -1.0, 0.0)),
        &look(
            99,
            &format!("{},{}", seen("cup", 1.0, 1.6), seen("cup", 1.0, 1.6)),
        ),
    ] {
        assert!(
            matches!(memory.take_line(line), MemoryReply::Refused(_)),
            "{line}"
        );
        assert_eq!(memory, before);
    }
}

proptest! {
    /// No line makes the reader panic.
    #[test]
    fn any_line_is_answered(line in ".{0,120}") {
        let mut memory = memory();
        let _ = memory.take_line(&line);
        let _ = memory.take_line(&format!("{{\"ask\":{}}}", serde_json::to_string(&line).unwrap()));
        prop_assert_eq!(memory.looks(), 0);
    }
}
