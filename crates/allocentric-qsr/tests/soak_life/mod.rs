//! A long life in a restless room: things appear, move and vanish, the eye wanders and its
//! measurement has holes. The suite lives for a few hundred looks, `cargo xtask soak-memory` for ten
//! thousand.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::collections::BTreeMap;

use allocentric_qsr::{
    AskedPlace, Evidence, GroundPose, Life, LookEvidence, MemoryParams, ObjectId, Policy, Refused,
    SceneMemory,
};

use super::room::{Eye, Room, memory};

/// Numbers that are the same on every machine.
struct Lot(u64);

impl Lot {
    /// From 0 to 1.
    fn part(&mut self) -> f64 {
        // Knuth's MMIX constants; the upper bits are the good ones.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1u64 << 31) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }
}

/// What a second observer counts for every remembered object: looks in a row with free space in
/// its place.
type Counts = BTreeMap<ObjectId, u32>;

/// The life of one memory: the sizes of its snapshots every hundredth look, and the last snapshot.
pub(crate) fn live(
    looks: u64,
    reload_at: Option<u64>,
    passed: impl Fn(u64),
) -> (Vec<usize>, String) {
    let params = MemoryParams {
        policy: Policy::Follow,
        ..MemoryParams::default()
    };
    let mut memory = memory(params);
    let (mut lot, mut room, mut born) = (Lot(1), Room::new(), 0u64);
    let (mut counts, mut sizes) = (Counts::new(), Vec::new());
    for look in 1..=looks {
        change(&mut room, &mut lot, &mut born);
        let [x, z] = [lot.between(-0.5, 0.5), lot.between(-0.5, 0.5)];
        let pose = GroundPose::new(x, z, lot.between(-3.0, 3.0)).unwrap();
        let hole = (lot.part() < 0.3).then(|| [lot.between(-0.5, 0.5), lot.between(0.5, 1.5), 0.4]);
        let eye = Eye {
            hole,
            ..Eye::new(&room, pose)
        };
        let noise: Vec<[f64; 2]> = room
            .iter()
            .map(|_| [lot.between(-1.5, 1.5), lot.between(-1.5, 1.5)])
            .collect();
        let taken = eye.look(look * 100, |k| noise[k]);
        let before = memory.clone();
        match memory.observe(&taken, &eye) {
            Ok(_) => {
                let seen: Vec<&ObjectId> = taken
                    .observations
                    .iter()
                    .map(|o| &o.sighting.object)
                    .collect();
                check(&before, &memory, &eye, &seen, &mut counts);
            }
            // Two things that are seen together and have both moved look like a wrong pose.
            Err(Refused::Moved { moved, known }) => {
                assert!(known >= 2 && moved.len() == known);
                assert_eq!(memory, before);
            }
            Err(other) => panic!("look {look}: {other}"),
        }
        if look % 100 == 0 {
            sizes.push(memory.to_json().len());
        }
        passed(look);
        if reload_at == Some(look) {
            let kept = memory.to_json();
            drop(memory);
            memory = SceneMemory::from_json(&kept).unwrap();
            assert_eq!(memory.to_json(), kept);
        }
    }
    (sizes, memory.to_json())
}

/// Now and then something comes, goes or is put elsewhere; names are used again, and there are at
/// most 40.
fn change(room: &mut Room, lot: &mut Lot, born: &mut u64) {
    let mut spot = || [lot.between(-2.0, 2.0), lot.between(-2.0, 2.0)];
    let (here, there) = (spot(), spot());
    let dice = lot.part();
    let at = (lot.part() * room.len() as f64) as usize;
    let some = room.keys().nth(at).cloned();
    if dice < 0.06 && room.len() < 15 {
        room.insert(format!("thing{}", *born % 40), here);
        *born += 1;
    } else if let Some(name) = some {
        if dice < 0.09 {
            room.remove(&name);
        } else if dice < 0.11 {
            room.insert(name, there);
        }
    }
}

/// No object is believed longer than its evidence allows, and none is given up earlier.
fn check(
    before: &SceneMemory,
    memory: &SceneMemory,
    eye: &Eye<'_>,
    seen: &[&ObjectId],
    counts: &mut Counts,
) {
    let params = memory.params();
    for (name, kept) in memory.objects() {
        if seen.contains(&name) {
            counts.insert(name.clone(), 0);
            assert!(matches!(kept.life, Life::InView | Life::Tentative));
            continue;
        }
        let was = before.object(name).unwrap();
        if was.life == Life::Removed {
            assert_eq!(kept, was, "a tombstone stays as it is");
            continue;
        }
        // Where it was before the look, seen from where the robot is now: it has not been seen,
        // so it is where it was.
        let place = kept.places[&memory.frame()];
        let [x, z] = place.position_m();
        let (sin, cos) = eye.pose.heading_rad().sin_cos();
        let (dx, dz) = (x - eye.pose.x_m(), z - eye.pose.z_m());
        let [[xx, xz], [_, zz]] = place.covariance_m2();
        let right = xx * cos * cos + 2.0 * xz * sin * cos + zz * sin * sin;
        let ahead = xx * sin * sin - 2.0 * xz * sin * cos + zz * cos * cos;
        let answer = eye.at(AskedPlace {
            right_m: dx * cos + dz * sin,
            forward_m: dz * cos - dx * sin,
            height_m: 0.0,
            within_m: f64::from(kept.radius_mm) / 1e3 + 3.0 * right.max(ahead).sqrt(),
            radius_m: f64::from(kept.radius_mm) / 1e3,
        });
        let count = counts.entry(name.clone()).or_default();
        *count += u32::from(answer == Evidence::FreeSpace);
        let tentative = was.life == Life::Tentative;
        let believed = !matches!(kept.life, Life::Missing | Life::Removed);
        assert_eq!(
            believed,
            *count < params.missing_after,
            "{name}: {count} {:?}",
            kept.life
        );
        let gone = if tentative {
            params.missing_after
        } else {
            params.removed_after
        };
        assert_eq!(
            kept.life == Life::Removed,
            *count >= gone,
            "{name}: {count} {:?}",
            kept.life
        );
    }
}

/// Lives twice, once with a reload in the middle, and compares; `passed` is told each look. Gives the
/// size of the snapshots in bytes, look by hundredth look.
///
/// # Panics
/// If a law does not hold.
pub(crate) fn soak(looks: u64, passed: impl Fn(u64)) -> Vec<usize> {
    let (sizes, last) = live(looks, None, &passed);
    let (again, same) = live(looks, Some(looks / 2), |look| passed(looks + look));
    assert_eq!(
        last, same,
        "a reload in the middle loses nothing, and every run gives these bytes"
    );
    assert_eq!(sizes, again);
    // After a third of the time every name and all ground has been met; what grows is digits.
    let third = sizes.len() / 3;
    let most = |sizes: &[usize]| sizes.iter().copied().max().unwrap();
    let (middle, end) = (most(&sizes[third..2 * third]), most(&sizes[2 * third..]));
    assert!(
        end as f64 <= 1.1 * middle as f64,
        "{middle} bytes have become {end}"
    );
    sizes
}
