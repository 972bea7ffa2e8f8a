use super::counts;
use super::look_memory::LookMemory;
use super::picture::PICTURE;
use super::report::{AtSize, Report};
use super::{shares, spread};
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
         over six scales. `responses, then matching` takes the same steps as `vector pyramid, no look back` to the same bits, one \
         level after the other. `depths of a field` is the first half of level 3, `objects and relations` the second with level 4. \
         A whole look is the facade's: the vector pyramid, which finds the range, dense `fast`, depths, objects and \
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
    page += &over_sizes(report);
    page += &memory(report);
    page += &ceilings(report);
    page += &instructions(report);
    for at in &report.sizes {
        page += &times(at);
    }
    page
}

/// Reached or missed.
const fn verdict(reached: bool) -> &'static str {
    if reached { "reached" } else { "missed" }
}

fn over_sizes(report: &Report) -> String {
    if report.spreads.is_empty() {
        return String::new();
    }
    let mut table = MarkdownTable::new([
        "contestant",
        "least, ns a pixel",
        "most, ns a pixel",
        "farthest from the median of the sizes, %",
        "mark, %",
        "",
    ]);
    for one in &report.spreads {
        table.push([
            one.name.to_owned(),
            format!("{:.1}", one.least_ns),
            format!("{:.1}", one.most_ns),
            format!("{:.0}", 100.0 * one.beyond_median),
            format!("{:.0}", 100.0 * spread::MARK),
            verdict(one.beyond_median <= spread::MARK).to_owned(),
        ]);
    }
    format!("\n## CPU time over the sizes\n\n{table}\n![time and memory a pixel]({PICTURE})\n")
}

fn memory(report: &Report) -> String {
    let Some(first) = report.sizes.first() else {
        return String::new();
    };
    let sizes = report.sizes.iter();
    let sizes = sizes.map(|at| format!("{} x {}", at.width, at.height));
    let head = ["workspace, bytes a pixel".to_owned()].into_iter();
    let mut table = MarkdownTable::with_head(
        head.chain(sizes)
            .chain(["allocations above 4 KiB a frame".to_owned()]),
    );
    for (place, one) in first.memory.iter().enumerate() {
        let all = report.sizes.iter().map(|at| &at.memory[place]);
        let bytes = all.clone().map(|one| format!("{:.0}", one.bytes_a_pixel));
        let large = all.map(|one| one.large_allocations_a_frame).max();
        let name = [one.name.to_owned()].into_iter();
        table.push(
            name.chain(bytes)
                .chain(large.map(|large| large.to_string())),
        );
    }
    let mut text = format!(
        "\n## Memory\n\nThe most bytes that a contestant asked the allocator for at once, from its plan to its third frame, beyond \
         the images: filters, buffers and results. Allocations are those of the second and third frame, the most at any size.\n\n{table}"
    );
    let looks: Vec<&LookMemory> = report.sizes.iter().flat_map(|at| &at.looks).collect();
    if looks.is_empty() {
        return text;
    }
    let mut table = MarkdownTable::new(["`dorsal look`", "size", "peak, MiB", "mark, MiB", ""]);
    for look in looks {
        table.push([
            if look.arguments.is_empty() {
                "two pictures alone".to_owned()
            } else {
                format!("`{}`", look.arguments)
            },
            format!("{} x {}", look.width, look.height),
            format!("{:.0}", look.peak_mib),
            format!("{:.0}", look.mark_mib),
            verdict(look.peak_mib <= look.mark_mib).to_owned(),
        ]);
    }
    text += &format!(
        "\nThe most memory that was resident in a process of the command, which also reads pictures and writes results:\n\n{table}"
    );
    text
}

fn ceilings(report: &Report) -> String {
    let Some(ceilings) = &report.ceilings else {
        return String::new();
    };
    let mut table = MarkdownTable::new([
        "vector pyramid",
        "size",
        "operations a pixel",
        "of the FMA ceiling, %",
        "mark, %",
        "",
        "least bytes a pixel",
        "of the copy ceiling, %",
    ]);
    for at in &report.sizes {
        for share in &at.shares {
            table.push([
                share.name.to_owned(),
                format!("{} x {}", at.width, at.height),
                format!("{:.0}", share.flops_a_pixel),
                format!("{:.1}", 100.0 * share.of_fma),
                format!("{:.0}", 100.0 * shares::MARK),
                verdict(share.of_fma >= shares::MARK).to_owned(),
                format!("{:.0}", share.least_bytes_a_pixel),
                format!("{:.1}", 100.0 * share.of_copy),
            ]);
        }
    }
    format!(
        "\n## Ceilings\n\nIn the same rounds one core did {:.1} GFLOP/s of independent fused multiplications in the widest vectors{}, and a \
         copy that no cache holds moved {:.1} GB/s, read and written. Operations are counted from the loops \
         (`xtask/src/bench/flops.rs`): a fused pair is two, comparisons, choices and thus medians are none. The least bytes are the \
         images read once, and the workspace written and read once.\n\n{table}",
        ceilings.fma_gflops,
        ceilings
            .eight_lanes_gflops
            .map_or_else(String::new, |gflops| format!(
                " ({gflops:.1} in eight lanes)"
            )),
        ceilings.copy_gb_s
    )
}

fn instructions(report: &Report) -> String {
    if let Some(why) = &report.uncounted {
        return format!("\n## Instructions\n\nNot counted: {why}.\n");
    }
    if report.counts.is_empty() {
        return String::new();
    }
    let mut table = MarkdownTable::new(["contestant", "instructions a pixel", "mark", ""]);
    for count in &report.counts {
        let mark = count.mark.map(|mark| {
            let reached = verdict(count.instructions_a_pixel <= mark);
            [format!("{mark:.0}"), reached.to_owned()]
        });
        let [mark, reached] = mark.unwrap_or_default();
        table.push([
            count.name.to_owned(),
            format!("{:.0}", count.instructions_a_pixel),
            mark,
            reached,
        ]);
    }
    format!(
        "\n## Instructions\n\nOf the second frame of {} as callgrind counts them on one thread, two frames less one. \
         Valgrind knows AVX2 and no AVX-512, so the code takes its path of eight lanes.\n\n{table}",
        counts::SIZE
    )
}

fn times(at: &AtSize) -> String {
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
    let mut two = MarkdownTable::new(["on two threads", "wall, ms", "times faster", "a second"]);
    for one in &at.two_threads {
        two.push([
            one.name.to_owned(),
            format!("{:.1}", one.wall_ms),
            format!("{:.2}", one.times_faster),
            format!("{:.1}", 1e3 / one.wall_ms),
        ]);
    }
    format!("\n## {} x {}\n\n{table}\n{two}", at.width, at.height)
}
