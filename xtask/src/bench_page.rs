use crate::bench::Report;
use crate::markdown_table::MarkdownTable;

/// The page of what was measured.
pub(crate) fn bench_page(report: &Report) -> String {
    let mut page = format!(
        "# Speed\n\nWritten by `{}` on {}, on {} ({} cores), {}, {} build. Medians of {} rounds, in each of which \
         every contestant runs once, with {} thread{} each{}. The pair is the project's rendered room; times go from the \
         images in memory to the field, for the vector pyramid with both banks over six scales. OpenCV's \
         matchers search 128 disparities (block 5; BM 15), as does `dense, fast`; DIS is its optical flow, medium preset.\n",
        report.command,
        report.date,
        report.machine.cpu,
        report.machine.cores,
        report.machine.rustc,
        report.machine.build,
        report.rounds,
        report.threads,
        if report.threads == 1 { "" } else { "s" },
        report
            .opencv
            .as_ref()
            .map_or_else(String::new, |version| format!("; OpenCV {version}")),
    );
    for at in &report.sizes {
        let sgbm = at.contestants.iter().find(|one| one.name == "SGBM");
        let mut table = MarkdownTable::new([
            "contestant",
            "CPU, ms",
            "least, ms",
            "wall, ms",
            "CPU, ns a pixel",
            "SGBM's CPU over this",
        ]);
        for one in &at.contestants {
            table.push([
                one.name.to_owned(),
                format!("{:.1}", one.cpu_ms),
                format!("{:.1}", one.least_cpu_ms),
                format!("{:.1}", one.wall_ms),
                format!("{:.0}", one.cpu_ns_a_pixel),
                sgbm.map_or_else(String::new, |sgbm| {
                    format!("{:.2}", sgbm.cpu_ms / one.cpu_ms)
                }),
            ]);
        }
        page += &format!("\n## {} x {}\n\n{table}", at.width, at.height);
    }
    page
}
