use std::process::Command;

use serde::Serialize;

/// The machine that a run happened on, as far as it tells.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Machine {
    /// Model of the processor.
    pub(crate) cpu: String,
    /// Cores that the run may use.
    pub(crate) cores: usize,
    /// What `rustc --version` says.
    pub(crate) rustc: String,
    /// How this program was built: times of a `debug` build say little.
    pub(crate) build: &'static str,
}

impl Machine {
    /// This machine.
    pub(crate) fn this() -> Self {
        Self {
            cpu: cpu().unwrap_or_else(unknown),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            rustc: first_line("rustc", &["--version"]).unwrap_or_else(unknown),
            build: if cfg!(debug_assertions) {
                "debug"
            } else {
                "release"
            },
        }
    }
}

fn unknown() -> String {
    "unknown".to_owned()
}

/// Linux names the processor in a file, macOS by a command.
fn cpu() -> Option<String> {
    let listed = std::fs::read_to_string("/proc/cpuinfo").ok();
    listed
        .as_deref()
        .and_then(model_name)
        .or_else(|| first_line("sysctl", &["-n", "machdep.cpu.brand_string"]))
}

fn model_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo
        .lines()
        .find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn first_line(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let line = text.lines().next()?.trim();
    (output.status.success() && !line.is_empty()).then(|| line.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_is_read_from_linux_list() {
        let list = "processor\t: 0\nvendor_id\t: A\nmodel name\t: A CPU @ 2 GHz\ncache size\t: 1\n";
        assert_eq!(model_name(list).as_deref(), Some("A CPU @ 2 GHz"));
        assert_eq!(model_name("processor : 0\n"), None);
    }

    #[test]
    fn this_machine_has_a_core() {
        assert!(Machine::this().cores > 0);
        assert_eq!(first_line("no such program", &[]), None);
    }
}
