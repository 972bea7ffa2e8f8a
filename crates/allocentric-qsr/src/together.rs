//! Two memories of one robot, read as one.

use crate::life::Life;
use crate::scene_memory::SceneMemory;

impl SceneMemory {
    /// What one robot remembers, of which a part is kept here and a part there: the looks of one room in the one
    /// memory, those of another room in the other. Both are in the robot's own frame, which nothing has to join.
    ///
    /// An object that both keep is as the one keeps it that saw it last. The robot, its changes and its free ground
    /// are those of the memory with the later look; facts of both are facts.
    ///
    /// A look without a pose opens a frame, so it belongs into both. If one of them has opened more frames than
    /// the other, nobody knows which of their frames are the same: then the older one is read as the memory of
    /// another robot ([`SceneMemory::beside`]), whose frames landmarks alone can join.
    ///
    /// The result is for questions: the numbers of its looks are those of neither.
    #[must_use]
    pub fn together(&self, other: &Self) -> Self {
        let (newer, older) = if other.time_ms > self.time_ms {
            (other, self)
        } else {
            (self, other)
        };
        if newer.frame != older.frame {
            return newer.beside([older]);
        }
        let mut both = newer.clone();
        both.looks = newer.looks.max(older.looks);
        for kept in both.objects.values_mut() {
            kept.last_look += both.looks - newer.looks;
        }
        for (name, kept) in &older.objects {
            // Of two who saw it at one time, the one who still believes in it.
            let is_newer = both.objects.get(name).is_none_or(|before| {
                (kept.last_time_ms, kept.life != Life::Removed)
                    > (before.last_time_ms, before.life != Life::Removed)
            });
            if is_newer {
                let mut kept = kept.clone();
                kept.last_look += both.looks - older.looks;
                both.objects.insert(name.clone(), kept);
            }
        }
        for fact in &older.facts {
            if !both.facts.contains(fact) {
                both.facts.push(fact.clone());
            }
        }
        both
    }
}
