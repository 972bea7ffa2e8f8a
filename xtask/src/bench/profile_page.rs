use super::contestants::{DENSE_FAST, DEPTHS, LOOK, NO_LOOK_BACK, OBJECTS, UNFUSED, VECTOR};
use super::counts::{Count, SIZE};
use super::flops::vector_flops;
use super::report::{AtSize, Report};
use super::stage::{OF_A_LOOK, OF_THE_PYRAMID, Stage};
use crate::markdown_table::MarkdownTable;
use disparity_pyramid::MatchParams;
use v1_gabor::GaborParams;

/// Where the time of a look goes; `None` unless instructions were counted.
pub(super) fn profile_page(report: &Report) -> Option<String> {
    let count = |name: &str| report.counts.iter().find(|count| count.name == name);
    let (look, before, after) = (count(LOOK)?, count(UNFUSED)?, count(NO_LOOK_BACK)?);
    let at = report.sizes.iter().min_by_key(|at| {
        let area = at.width * at.height;
        area.abs_diff(1024 * 768)
    })?;
    let mut page = format!(
        "# Where the time of a look goes\n\nWritten by `{}` on {}, on {} ({} cores), {}, {} build. Instructions are those of the second \
         frame of {SIZE} as callgrind counts them on one thread (AVX2, the widest that valgrind knows), each function with all that it calls; \
         what is done in a function that was inlined counts for the one around it. Times are medians of {} rounds at {} x {} with the \
         widest vectors that the machine has, {} thread{}.\n",
        report.command,
        report.date,
        report.machine.cpu,
        report.machine.cores,
        report.machine.rustc,
        report.machine.build,
        report.rounds,
        at.width,
        at.height,
        report.threads,
        if report.threads == 1 { "" } else { "s" },
    );
    page += &a_look(look, at);
    page += &fused(before, after, at);
    page += &next_factor(look, after);
    Some(page)
}

/// Instructions a pixel of a stage; `None` if it is no function of its own in this build.
fn of_stage(count: &Count, stage: &Stage) -> Option<f64> {
    let functions = count.instructions.with_calls.iter();
    let found = functions.filter(|(name, _)| stage.is(name));
    let found: u64 = found.map(|(_, instructions)| instructions).sum();
    (found > 0).then(|| found as f64 / SIZE.area() as f64)
}

fn cpu_ms(at: &AtSize, name: &str) -> Option<f64> {
    let found = at.contestants.iter().find(|one| one.name == name)?;
    Some(found.cpu_ms)
}

fn a_look(look: &Count, at: &AtSize) -> String {
    let total = look.instructions_a_pixel;
    let mut table = MarkdownTable::new(["stage", "instructions a pixel", "% of the look"]);
    for stage in &OF_A_LOOK {
        let Some(instructions) = of_stage(look, stage) else {
            continue;
        };
        table.push([
            format!("{}{}", "- ".repeat(stage.depth), stage.name),
            format!("{instructions:.1}"),
            format!("{:.1}", 100.0 * instructions / total),
        ]);
    }
    table.push([
        "whole look".to_owned(),
        format!("{total:.1}"),
        "100.0".to_owned(),
    ]);
    let mut times = MarkdownTable::new(["of a look, each by itself", "CPU, ms", "ns a pixel"]);
    let parts = [VECTOR, DENSE_FAST, DEPTHS, OBJECTS, LOOK];
    for one in at
        .contestants
        .iter()
        .filter(|one| parts.contains(&one.name))
    {
        times.push([
            one.name.to_owned(),
            format!("{:.1}", one.cpu_ms),
            format!("{:.1}", one.cpu_ns_a_pixel),
        ]);
    }
    format!(
        "\n## One look, stage by stage\n\nIndented stages are parts of the one above.\n\n{table}\n{times}"
    )
}

fn fused(before: &Count, after: &Count, at: &AtSize) -> String {
    let mut table = MarkdownTable::new(["", "one level after the other", "in one visit"]);
    for stage in &OF_THE_PYRAMID {
        let of = |count| {
            of_stage(count, stage).map_or_else(|| "-".to_owned(), |found| format!("{found:.0}"))
        };
        let name = format!("{}, instructions a pixel", stage.name);
        table.push([name, of(before), of(after)]);
    }
    table.push([
        "all, instructions a pixel".to_owned(),
        format!("{:.0}", before.instructions_a_pixel),
        format!("{:.0}", after.instructions_a_pixel),
    ]);
    let time = |name| cpu_ms(at, name).map_or_else(String::new, |ms| format!("{ms:.1}"));
    table.push(["CPU, ms".to_owned(), time(UNFUSED), time(NO_LOOK_BACK)]);
    let bytes = |name| {
        let found = at.memory.iter().find(|one| one.name == name);
        found.map_or_else(String::new, |one| format!("{:.0}", one.bytes_a_pixel))
    };
    table.push([
        "workspace, bytes a pixel".to_owned(),
        bytes(UNFUSED),
        bytes(NO_LOOK_BACK),
    ]);
    format!(
        "\n## Before and after levels 1 and 2 became one visit\n\nThe vector pyramid without its look back, to the same bits. Before, all \
         responses of both eyes are written to memory, and the matching reads them; now the finest ones are computed row by row where the \
         warp reads them, the left eye's only where a pixel is fitted.\n\n{table}"
    )
}

fn next_factor(look: &Count, pyramid: &Count) -> String {
    let mut parts: Vec<(&str, f64)> = OF_A_LOOK
        .iter()
        .filter(|stage| stage.depth == 0 && !stage.name.contains("within"))
        .filter_map(|stage| Some((stage.name, of_stage(look, stage)?)))
        .collect();
    parts.sort_by(|one, other| other.1.total_cmp(&one.1));
    let largest = parts.first().map(|&(name, instructions)| {
        let part = instructions / look.instructions_a_pixel;
        format!(
            "Without the largest stage, {name}, a look would be {:.1} times as fast, which bounds what work on one stage can give. ",
            1.0 / (1.0 - part)
        )
    });
    let largest = largest.unwrap_or_default();
    let mut table = MarkdownTable::new([
        "stage",
        "look's instructions if it were free, %",
        "if it took half, %",
    ]);
    for (name, instructions) in parts {
        let part = instructions / look.instructions_a_pixel;
        table.push([
            name.to_owned(),
            format!("{:.0}", 100.0 * (1.0 - part)),
            format!("{:.0}", 100.0 * (1.0 - 0.5 * part)),
        ]);
    }
    let params = MatchParams {
        left_right_px: None,
        ..MatchParams::default()
    };
    let bank = GaborParams::default().fitted_to(SIZE);
    let operations = vector_flops(SIZE, &bank, &params) / SIZE.area() as f64;
    // A fused multiplication of eight lanes does sixteen.
    let least = operations / 16.0;
    let stages = OF_THE_PYRAMID
        .iter()
        .filter_map(|stage| Some((stage.name, of_stage(pyramid, stage)?)));
    let stages: Vec<(&str, f64)> = stages.collect();
    let named: f64 = stages.iter().map(|stage| stage.1).sum();
    let stages: Vec<String> = stages
        .iter()
        .map(|(name, instructions)| format!("{name} {instructions:.0}"))
        .collect();
    format!(
        "\n## What the next factor needs\n\n{table}\n{largest}The vector pyramid's {operations:.0} operations a pixel would fit into \
         {least:.0} fused instructions of eight lanes. It takes {:.0} ({}, the rest {:.0}): sums that are no products, reading, turning, \
         choosing and sorting are instructions too.\n",
        pyramid.instructions_a_pixel,
        stages.join(", "),
        pyramid.instructions_a_pixel - named,
    )
}
