use super::report::Report;
use crate::markdown_table::MarkdownTable;

/// The page of what was measured.
pub(super) fn bench_page(report: &Report) -> String {
    let mut page = format!(
        "# Speed\n\nWritten by `{}` on {}, on {} ({} cores), {}, {} build. Medians of {} rounds, in each of which \
         every contestant runs once, with {} thread{} each{}. The vector pyramid and DIS (OpenCV's optical flow, medium preset) see the \
         project's rendered room as its head does, with eyes that converge; the dense estimator and OpenCV's other \
         matchers, which search 128 disparities along rows (block 5; BM 15), see it with parallel eyes, as both ask for a \
         rectified pair. `dense, fast, verged pair` is given the former all the same: hardly anything matches along rows there, \
         so a coarse look narrows little. Times go from the images in memory to the field, for the vector pyramid with both banks \
         over six scales. A whole look is the facade's: the vector pyramid, which finds the range, dense `fast`, depths, objects and \
         relations, on a frame of parallel eyes with labels that is held in memory.\n",
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
        let mut two =
            MarkdownTable::new(["on two threads", "wall, ms", "times faster", "a second"]);
        for one in &at.two_threads {
            two.push([
                one.name.to_owned(),
                format!("{:.1}", one.wall_ms),
                format!("{:.2}", one.times_faster),
                format!("{:.1}", 1e3 / one.wall_ms),
            ]);
        }
        page += &format!("\n## {} x {}\n\n{table}\n{two}", at.width, at.height);
    }
    page
}
