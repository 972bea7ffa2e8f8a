use std::fs;
use std::path::Path;

use anyhow::Context;

use crate::eval_middlebury::write_file;

/// Where the section of the scans begins in docs/results.md.
const HEADING: &str = "\n## A head that scans rooms\n";

/// A page of results with what docs/scan.md tells of all rooms together as its last section: the two are
/// written by different tasks, and neither may lose what the other has measured.
pub(crate) fn with_scan(results: &str, scan: &str) -> String {
    let results = results.split(HEADING).next().unwrap_or(results);
    let told = scan.split("\n- compiler:").nth(1).unwrap_or_default();
    let told = told.split_once('\n').map_or("", |(_, told)| told);
    let told = told.split("\n## Rooms\n").next().unwrap_or(told);
    format!(
        "{}\n{HEADING}\nOf [the scans](scan.md), which has every room.\n\n{}\n",
        results.trim_end(),
        told.trim()
    )
}

/// Brings the section of docs/results.md up to date with docs/scan.md; a page that is missing is left alone.
pub(crate) fn refresh(docs: &Path) -> anyhow::Result<()> {
    let [results, scan] = ["results.md", "scan.md"].map(|name| docs.join(name));
    if !results.exists() || !scan.exists() {
        return Ok(());
    }
    let read = |path: &Path| {
        fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))
    };
    let page = with_scan(&read(&results)?, &read(&scan)?);
    write_file(&results, page.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_is_replaced_and_nothing_else() {
        let scan =
            "# S\n\n- date\n- compiler: rustc\n\nfifty rooms\n\n- zero\n\n## Rooms\n\ntable\n";
        let once = with_scan("# Results\n\npairs\n", scan);
        assert!(
            once.starts_with("# Results\n\npairs\n\n## A head"),
            "{once}"
        );
        assert!(once.contains("fifty rooms\n\n- zero\n"), "{once}");
        assert!(!once.contains("table"), "{once}");
        assert_eq!(with_scan(&once, scan), once);
    }
}
