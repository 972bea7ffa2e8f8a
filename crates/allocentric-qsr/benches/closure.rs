//! How long the closure of a network takes, what one more fact costs, and how both grow.
//!
//! Networks have a place in the plane: objects in a square room, facts to 12 others each on
//! average, every fact the true class of five, alone or with others added at random. After the usual figures the
//! medians stand beside the marks the design sets, with the exponents of growth.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench sets up what exists"
)]

use std::hint::black_box;
use std::time::Instant;

use allocentric_qsr::{
    Closure, ConstraintNetwork, DepthClass, DepthReference, DepthSet, DistanceFact, FactSource,
    Look, MemoryParams, NoDepth, ObjectId, Observation, PoseKnowledge, RobotPose, SceneMemory,
    Sighting, TriangleTable,
};
use criterion::{BenchmarkId, Criterion};

const SIZES: [usize; 4] = [100, 300, 1000, 3000];

/// Facts for every object, counted at both of their ends.
const DEGREE: usize = 12;

/// A generator of even numbers is enough here, and the same on every machine.
struct Lot(u64);

impl Lot {
    fn below(&mut self, bound: u64) -> u64 {
        // Knuth's MMIX constants; the upper bits are the good ones.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}

fn name(k: usize) -> ObjectId {
    ObjectId::new(format!("o{k:04}"))
}

/// A system of so many classes, 10 cm each.
fn of_classes(count: u32) -> DepthReference {
    let class = |k: u32| DepthClass {
        short: format!("k{k}"),
        name: format!("class_{k}"),
        from_mm: 100 * k,
    };
    DepthReference::new("even", (0..count).map(class).collect()).unwrap()
}

/// The places of the objects of a square room, in millimetres.
fn room(count: usize, spread_mm: f64, lot: &mut Lot) -> Vec<[i64; 2]> {
    let side = (count as f64).sqrt() * spread_mm;
    (0..count)
        .map(|_| [lot.below(side as u64) as i64, lot.below(side as u64) as i64])
        .collect()
}

fn facts(
    reference: &DepthReference,
    room: &[[i64; 2]],
    count: usize,
    vague: bool,
    lot: &mut Lot,
) -> Vec<DistanceFact> {
    let mut facts = Vec::new();
    while facts.len() < count {
        let [i, j] = [0, 1].map(|_| lot.below(room.len() as u64) as usize);
        if i == j {
            continue;
        }
        let squared = [0, 1].map(|axis| (room[i][axis] - room[j][axis]).pow(2));
        let truth = reference.qualify_mm(((squared[0] + squared[1]) as u64).isqrt());
        let near = truth != reference.last();
        // Most objects of a large room are very far from each other; near facts bind.
        if !near && lot.below(8) > 0 {
            continue;
        }
        let others: DepthSet = reference
            .all()
            .iter()
            .filter(|_| vague && lot.below(4) == 0)
            .collect();
        facts.push(DistanceFact {
            between: [name(i), name(j)],
            depth: others | truth.into(),
            source: FactSource::Told(String::new()),
        });
    }
    facts
}

fn closed(reference: &DepthReference, count: usize, facts: &[DistanceFact]) -> ConstraintNetwork {
    let mut network = ConstraintNetwork::new(reference, (0..count).map(name));
    let closure = network.constrain(facts.to_vec()).unwrap();
    assert!(
        matches!(closure, Closure::NotRefuted { .. }),
        "the room has these distances"
    );
    network
}

fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

fn time<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let done = black_box(work());
    (start.elapsed().as_secs_f64(), done)
}

/// The processor time of some work in seconds, so that other programs of the machine do not count;
/// where the system does not tell it, the time of the wall. Its grain is a few milliseconds.
fn cpu_time<T>(work: impl FnOnce() -> T) -> f64 {
    let spent = || -> Option<f64> {
        let stat = std::fs::read_to_string("/proc/self/schedstat").ok()?;
        Some(stat.split_whitespace().next()?.parse::<f64>().ok()? / 1e9)
    };
    let before = spent();
    let (wall_s, _) = time(work);
    before
        .zip(spent())
        .map_or(wall_s, |(before, after)| after - before)
}

/// The slope of log time over log size, by least squares.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(n, t)| (n.ln(), t.ln())).collect();
    let count = logs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let over: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    over / logs.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

/// A memory of so many objects around the robot, all in one frame.
fn remembered(reference: &DepthReference, count: usize) -> SceneMemory {
    let mut lot = Lot(7);
    let seen = (0..count).map(|k| Sighting {
        object: name(k),
        distance_m: 0.3 + lot.below(5000) as f64 / 1000.0,
        bearing_rad: lot.below(6283) as f64 / 1000.0,
        sigma_distance_m: 0.01,
        sigma_bearing_rad: 0.005,
    });
    let look = Look {
        time_ms: 0,
        pose: PoseKnowledge::Known(RobotPose::default()),
        observations: seen.map(Observation::from).collect(),
    };
    let mut memory = SceneMemory::new(reference, MemoryParams::default()).unwrap();
    memory.observe(&look, &NoDepth).unwrap();
    memory
}

/// A kind of network.
struct Scene {
    kind: &'static str,
    /// One object to a square of this side, in millimetres.
    spread_mm: f64,
    /// Whether other classes are added to the true one.
    vague: bool,
}

/// Times the closure at all sizes and prints how it grows.
fn scale(criterion: &mut Criterion, reference: &DepthReference, scene: Scene) {
    let Scene {
        kind,
        spread_mm,
        vague,
    } = scene;
    let mut full = Vec::new();
    let mut added = Vec::new();
    for count in SIZES {
        let mut lot = Lot(42 + count as u64);
        let room = room(count, spread_mm, &mut lot);
        let told = facts(reference, &room, count * DEGREE / 2, vague, &mut lot);
        let more = facts(reference, &room, 200, vague, &mut lot);
        criterion.bench_with_input(BenchmarkId::new(kind, count), &count, |b, &count| {
            b.iter(|| closed(reference, count, &told));
        });
        // Enough runs in a row to be long against the grain of the processor's clock, and the best
        // of several such rows, for other programs of the machine take their share of its caches.
        let runs = 9000 / count;
        let row = |_| cpu_time(|| (0..runs).for_each(|_| drop(closed(reference, count, &told))));
        let full_s = (0..5).map(row).fold(f64::INFINITY, f64::min) / runs as f64;
        let mut network = ConstraintNetwork::new(reference, (0..count).map(name));
        let Closure::NotRefuted { narrowed: before } = network.constrain(told).unwrap() else {
            panic!("the room has these distances");
        };
        let (mut steps, mut narrowed) = (Vec::new(), 0);
        for fact in more {
            let (seconds, closure) = time(|| network.constrain([fact]).unwrap());
            steps.push(seconds);
            if let Closure::NotRefuted { narrowed: pairs } = closure {
                narrowed += pairs;
            }
        }
        let step_s = median(steps);
        println!(
            "- {kind}, n = {count}: full closure {full_s:.4} s of CPU ({before} pairs narrowed), \
             one more fact {:.1} us (median of 200, {narrowed} pairs narrowed)",
            step_s * 1e6
        );
        full.push((count as f64, full_s));
        added.push((count as f64, step_s));
    }
    println!(
        "- {kind}: full closure grows with n to the power {:.2}",
        exponent(&full)
    );
    println!(
        "- {kind}: one more fact grows with n to the power {:.2}",
        exponent(&added)
    );
}

fn main() {
    let reference = DepthReference::robot_120();
    let mut criterion = Criterion::default().sample_size(10).configure_from_args();
    let fine = DepthReference::drs2();
    criterion.bench_function("triangle table of 7 classes", |b| {
        b.iter(|| TriangleTable::plan(black_box(&fine)));
    });
    for scene in [
        Scene {
            kind: "vague facts",
            spread_mm: 1000.0,
            vague: true,
        },
        Scene {
            kind: "exact facts",
            spread_mm: 1000.0,
            vague: false,
        },
        Scene {
            kind: "exact facts in a crowd",
            spread_mm: 300.0,
            vague: false,
        },
    ] {
        scale(&mut criterion, &reference, scene);
    }
    println!("- marks at n = 1000: full closure 0.2 s, one more fact 100 us");

    let tables = (0..101).map(|_| time(|| TriangleTable::plan(&fine)).0);
    println!(
        "- triangle table of 7 classes planned in {:.3} ms, median of 101 (mark 1)",
        median(tables.collect()) * 1e3
    );
    let count = 1000;
    let pairs = count * (count - 1) / 2;
    for classes in [5, 8, 16, 32] {
        let network = ConstraintNetwork::new(&of_classes(classes), (0..count).map(name));
        println!(
            "- a network of {classes} classes takes {:.2} bytes a pair (mark 8)",
            network.bytes() as f64 / pairs as f64
        );
    }

    let mut requalified = Vec::new();
    for count in SIZES {
        let memory = remembered(&reference, count);
        let runs = (0..9).map(|_| time(|| memory.depths()));
        let runs = runs.map(|(seconds, depths)| {
            assert_eq!(depths.len(), count * (count - 1) / 2);
            seconds
        });
        let best_s = runs.fold(f64::INFINITY, f64::min);
        println!(
            "- all pairs of {count} objects requalified in {:.1} ms, best of 9{}",
            best_s * 1e3,
            if count == 1000 { " (mark 30)" } else { "" }
        );
        requalified.push((count as f64, best_s));
    }
    println!(
        "- requalifying all pairs grows with n to the power {:.2}",
        exponent(&requalified)
    );
    criterion.final_summary();
}
