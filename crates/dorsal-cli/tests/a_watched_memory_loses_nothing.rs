//! `dorsal memory watch` answers line by line, and what it has answered outlives it.
mod command;
mod desk;

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use desk::Desk;
use serde_json::{Value, json};

/// A running `dorsal memory watch`.
struct Watch {
    child: Child,
    lines: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Watch {
    fn of(desk: &Desk) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_dorsal"))
            .args(["memory", "watch", "--memory"])
            .arg(desk.path("memory.json"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the command runs");
        Self {
            lines: child.stdin.take().expect("a pipe"),
            answers: BufReader::new(child.stdout.take().expect("a pipe")),
            child,
        }
    }

    fn says(&mut self, line: &str) -> Value {
        writeln!(self.lines, "{line}").expect("it listens");
        let mut answer = String::new();
        self.answers.read_line(&mut answer).expect("it answers");
        serde_json::from_str(&answer).expect("JSON")
    }
}

fn look(time_ms: u64, names: &[String]) -> String {
    let seen = names.iter().enumerate().map(|(k, name)| {
        json!({
            "object": name, "distance_m": 0.5 + 0.1 * k as f64, "bearing_rad": 1.6,
            "sigma_distance_m": 0.01, "sigma_bearing_rad": 0.005,
        })
    });
    let pose = json!({"x_m": 0, "z_m": 0, "heading_rad": 0});
    let seen: Vec<Value> = seen.collect();
    json!({"look": {"time_ms": time_ms, "pose": pose, "seen": seen}}).to_string()
}

#[test]
fn a_kill_in_the_middle_loses_nothing_answered() {
    let desk = Desk::new();
    let mut names = Vec::new();
    for round in 0..3u64 {
        let mut watch = Watch::of(&desk);
        for step in 0..5 {
            names.push(format!("thing{round}_{step}"));
            let answer = watch.says(&look(10 * round + step, &names));
            assert!(answer["changes"].is_array(), "{answer}");
        }
        let fact = format!("lamp{round} within vc of thing{round}_0");
        let answer = watch.says(&json!({"tell": fact}).to_string());
        assert_eq!(answer["changes"][0]["fact"], fact.as_str());
        // No farewell: the process is ended as a power switch would, but for the disk.
        watch.child.kill().expect("it runs");
        watch.child.wait().expect("it ends");
    }
    let shown: Value = serde_json::from_str(&desk.bytes()).expect("a whole memory");
    assert_eq!(shown["looks"], 15);
    assert_eq!(shown["facts"].as_array().map(Vec::len), Some(3));
    for name in &names {
        assert!(shown["objects"][name].is_object(), "{name}");
    }
}

#[test]
fn refused_lines_change_and_end_nothing() {
    let desk = Desk::new();
    let mut watch = Watch::of(&desk);
    assert!(watch.says(&look(5, &["cup".to_owned()]))["changes"].is_array());
    let before = desk.bytes();
    for line in [
        "what?",
        "{}",
        "{\"ask\": \"up of cup\"}",
        "{\"ask\": \"where ghost\"}",
        "{\"tell\": \"cup within vc of cup\"}",
        &look(4, &[]),
        &look(6, &["cup".to_owned(), "cup".to_owned()]),
    ] {
        let answer = watch.says(line);
        assert!(answer["refused"].is_string(), "{line}: {answer}");
        assert_eq!(desk.bytes(), before);
    }
    let answer = watch.says("{\"ask\": \"within vc of robot\"}");
    assert_eq!(answer["answer"]["certain"], json!(["cup"]));
    // Nobody else changes a memory that is watched; to read it is free.
    let said = desk.memory(&["tell", "lamp within vc of cup"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("held by another dorsal"), "{}", said.err);
    assert_eq!(desk.memory(&["ask", "last_seen cup"]).code, Some(0));
    // The end of the lines is the end of the command.
    let Watch {
        mut child, lines, ..
    } = watch;
    drop(lines);
    assert!(child.wait().expect("it ends").success());
    assert_eq!(
        desk.memory(&["tell", "lamp within vc of cup"]).code,
        Some(0)
    );
}
