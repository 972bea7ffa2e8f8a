//! Every subcommand has help with examples; shells and `man` get theirs.
mod command;

use command::dorsal;

/// The subcommands that a help text lists.
fn listed(path: &[&str]) -> Vec<String> {
    let said = dorsal(path.iter().chain(&["--help"]));
    assert_eq!(said.code, Some(0), "{path:?}");
    let commands = said
        .out
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1);
    commands
        .take_while(|line| line.starts_with("  "))
        .filter(|line| !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next().map(str::to_owned))
        .filter(|name| name != "help")
        .collect()
}

#[test]
fn every_subcommand_has_examples() {
    let mut left: Vec<Vec<String>> = vec![Vec::new()];
    let mut met = 0;
    while let Some(path) = left.pop() {
        let words: Vec<&str> = path.iter().map(String::as_str).collect();
        let help = dorsal(words.iter().chain(&["--help"]));
        assert!(
            help.out.contains("Example"),
            "{path:?} has no example:\n{}",
            help.out
        );
        let call = format!("dorsal {}", path.join(" "));
        assert!(
            help.out.contains(call.trim_end()),
            "{path:?} shows no call of its own"
        );
        met += 1;
        for inner in listed(&words) {
            left.push([path.clone(), vec![inner]].concat());
        }
    }
    assert!(met > 20, "only {met} subcommands were met");
}

#[test]
fn shells_complete_the_commands_words() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let said = dorsal(["completions", shell]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        for word in ["calibrate", "every-frame", "live", "recalibrate"] {
            assert!(said.out.contains(word), "{shell}: {word}");
        }
    }
    assert_eq!(dorsal(["completions", "tea"]).code, Some(2));
}

#[test]
fn man_has_a_page_for_every_subcommand() {
    let said = dorsal(["man"]);
    assert!(said.out.contains(".TH dorsal 1"), "{}", said.out);
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("man1");
    let said = dorsal(["man".as_ref(), "--out".as_ref(), out.as_os_str()]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    for name in [
        "dorsal",
        "dorsal-look",
        "dorsal-demo-scan",
        "dorsal-memory-ask",
    ] {
        let page = std::fs::read_to_string(out.join(format!("{name}.1"))).expect(name);
        assert!(page.contains(&format!(".TH {name} 1")), "{page}");
        assert!(page.contains("Examples"), "{name}");
    }
}
