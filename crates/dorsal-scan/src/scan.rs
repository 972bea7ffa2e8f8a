use dorsal::allocentric_qsr::{
    AskedPlace, BadMemoryParams, BadSighting, DepthReference, Evidence, FreePath, GroundPose, Look,
    LookEvidence as _, MemoryParams, NotAPose, NotAnError, ObjectId, Observation, Observer, Policy,
    PoseKnowledge, QualifyParams, QualitativeScene, RobotPose, SceneMemory,
};
use dorsal::disparity_pyramid::{DenseParams, EyeView, MatchParams};
use dorsal::egocentric_depth::{
    BadRig, DepthMap, DriftBelief, Label, LabelImage, Lens, LocateParams, LocatedObject, NoSigma,
    NotLocatable, OrientationParams, Position, StereoRig, locate, relative_orientation,
    triangulate,
};
use dorsal::v1_gabor::{BadParams, Binocular, FilterBank, GaborParams, LumaImage, NotAnImage};
use dorsal::{
    DenseLook, DepthEvidence, Error, Foot, Percept, Range, Rows, Search, SeenThings, object_id,
    observations, sightings,
};
use ndarray::{Array2, Array3, Axis};
use stereo_scenes::{Exposure, Gaze, Head, NoGaze, NoView, Room, View, render};

use crate::asked::{hand, hand_way};
use crate::attention::{Attention, SeenThing, shows};
use crate::chance::Chance;
use crate::field::Field;
use crate::fixation::{Fixation, Why};
use crate::head_errors::HeadErrors;
use crate::relocation::Relocation;
use crate::scan_look::{ScanLook, Shown};
use crate::score::{Score, is_free};
use crate::true_places::{TruePlaces, names};

/// How to scan a room.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanParams {
    /// How many fixations.
    pub fixations: usize,
    /// Chooses noise and errors, and what is moved.
    pub seed: u64,
    /// What the head gets wrong.
    pub errors: HeadErrors,
    /// How the cameras turn light into samples; the seed of the noise comes from the scan's.
    pub exposure: Exposure,
    /// Which ground is looked at.
    pub field: Field,
    /// Whether one object is moved half way.
    pub moves: bool,
    /// The distance classes.
    pub reference: DepthReference,
    /// How the memory believes.
    pub memory: MemoryParams,
}

impl Default for ScanParams {
    /// Ten fixations of a head with errors and a camera's noise, squares of free ground of 3 cm.
    fn default() -> Self {
        Self {
            fixations: 10,
            seed: 2,
            errors: HeadErrors::default(),
            exposure: Exposure {
                noise_sigma: 0.01,
                ..Exposure::default()
            },
            field: Field::default(),
            moves: true,
            reference: DepthReference::robot_120(),
            memory: MemoryParams {
                // A hand that moves things contradicts nothing: what is seen has moved.
                policy: Policy::Follow,
                // A ball around a square of 3 cm is asked by hands of 3 cm, and leaves the ground alone.
                cell_mm: 30,
                ground_mm: 2000,
                // A ball of 2.7 cm radius above the stand by 1.3 cm: lower things are noticed as
                // objects or not at all.
                above_ground_mm: 40,
                // With the looks that make sure at the end, two rounds of a table.
                trusted_looks: 6,
                ..MemoryParams::default()
            },
        }
    }
}

/// Why a scan cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum NoScan {
    /// The room has no object.
    #[error("the room has no object; add an [[object]] to it")]
    Empty,
    /// The head cannot look there.
    #[error(transparent)]
    Gaze(#[from] NoGaze),
    /// The head sees no room.
    #[error(transparent)]
    View(#[from] NoView),
    /// The eyes cannot be as the errors have them.
    #[error(transparent)]
    Rig(#[from] BadRig),
    /// The picture is none.
    #[error(transparent)]
    Image(#[from] NotAnImage),
    /// The filters cannot be planned.
    #[error(transparent)]
    Filters(#[from] BadParams),
    /// A level refused the look.
    #[error(transparent)]
    Look(#[from] Error),
    /// The objects cannot be located.
    #[error(transparent)]
    Locate(#[from] NotLocatable),
    /// An error of the head is none.
    #[error(transparent)]
    Sigma(#[from] NoSigma),
    /// The pose is none.
    #[error(transparent)]
    Pose(#[from] NotAPose),
    /// The error of the pose is none.
    #[error(transparent)]
    PoseError(#[from] NotAnError),
    /// The parameters of the memory cannot be.
    #[error(transparent)]
    Memory(#[from] BadMemoryParams),
    /// A sighting is none.
    #[error(transparent)]
    Sighting(#[from] BadSighting),
}

/// A head that scans a room, between two looks.
#[derive(Clone, Debug)]
pub struct Scan {
    params: ScanParams,
    room: Room,
    head: Head,
    stand_m: f64,
    lenses: Binocular<Lens>,
    chance: Chance,
    bank: FilterBank,
    belief: Option<DriftBelief>,
    attention: Attention,
    relocation: Option<Relocation>,
    memory: SceneMemory,
    looks: usize,
}

/// How many looks make sure at the end of a scan of what was not seen for long ([`Scan::make_sure`]): so
/// many go around a table.
pub const LAST_LOOKS: usize = 3;

/// Time between two looks, in milliseconds of the scan's clock.
const PERIOD_MS: u64 = 1000;

impl Scan {
    /// A head in a room that it has not looked at.
    ///
    /// # Errors
    /// [`NoScan`] says what is wrong with the room or the parameters.
    pub fn begin(room: Room, params: ScanParams) -> Result<Self, NoScan> {
        let memory = SceneMemory::new(&params.reference, params.memory)?;
        Self::resume(room, params, memory)
    }

    /// A head that comes back with a memory of the room.
    ///
    /// # Errors
    /// As [`Scan::begin`].
    pub fn resume(room: Room, params: ScanParams, memory: SceneMemory) -> Result<Self, NoScan> {
        let head = room.head();
        let feet = room.objects().iter().map(|thing| thing.shape.foot_m());
        let stand_m = feet.min_by(f64::total_cmp).ok_or(NoScan::Empty)?;
        let mut chance = Chance::new(params.seed);
        let relocation = if params.moves {
            Relocation::find(&room, &head, &params.field, params.seed)?
        } else {
            None
        };
        let gabor = GaborParams::default();
        let gabor = GaborParams {
            // The nearest edge of a table is far from the fixation in pixels.
            scales: gabor.most_scales(head.size),
            ..gabor
        };
        Ok(Self {
            lenses: params.errors.lenses(&mut chance),
            bank: FilterBank::plan(gabor.fitted_to(head.size), head.size)?,
            attention: Attention::new(params.field.places()),
            room,
            head,
            stand_m,
            chance,
            belief: None,
            relocation,
            memory,
            params,
            looks: 0,
        })
    }

    /// How it scans.
    #[must_use]
    pub const fn params(&self) -> &ScanParams {
        &self.params
    }

    /// The room as it is now.
    #[must_use]
    pub const fn room(&self) -> &Room {
        &self.room
    }

    /// The memory.
    #[must_use]
    pub const fn memory(&self) -> &SceneMemory {
        &self.memory
    }

    /// How far below the eyes the things stand, in metres.
    #[must_use]
    pub fn eyes_above_ground_m(&self) -> f64 {
        self.head.position_m[2] - self.stand_m
    }

    /// The part of the field that some look has measured.
    #[must_use]
    pub fn known(&self) -> f64 {
        self.attention.known()
    }

    /// Where to look next; nothing when all fixations are done.
    #[must_use]
    pub fn next(&self) -> Option<Fixation> {
        if self.looks >= self.params.fixations {
            return None;
        }
        let down_m = self.eyes_above_ground_m();
        let (at, height_m, why) =
            self.attention
                .next(&self.memory, self.head.size, down_m, |at| self.aim(at))?;
        Some(Fixation {
            point_m: [at[0], down_m - height_m, at[1]],
            why,
        })
    }

    /// A fixation that has one remembered object in view and another, its screen included, out of the
    /// views of both eyes: the look of Figure 12. Nothing if no place of the field gives one.
    #[must_use]
    pub fn without(&self, shown: &ObjectId, hidden: &ObjectId) -> Option<Fixation> {
        let place = |object| {
            let place = self.memory.from_robot(object)?;
            Some([place.right_m, place.forward_m])
        };
        let (wanted, unwanted) = (place(shown)?, place(hidden)?);
        let radius_m = f64::from(self.memory.object(hidden)?.radius_mm) / 1e3;
        let (size, down_m) = (self.head.size, self.eyes_above_ground_m());
        let sees = |rig: &StereoRig, [right, forward]: [f64; 2]| {
            let up_m = down_m - radius_m;
            let point = Position::new(right, up_m, forward);
            rig.project(rig.to_head(point)).is_some_and(|eyes| {
                [eyes.left, eyes.right]
                    .into_iter()
                    .any(|(x, y)| (0.0..size.width as f64).contains(&x) && y.is_finite())
            })
        };
        let around = [-1.5, 0.0, 1.5].map(|aside| [unwanted[0] + aside * radius_m, unwanted[1]]);
        let mut places: Vec<[f64; 2]> = self.attention.places().collect();
        // The nearest to the object that is wanted shows it best.
        places.sort_by(|a, b| {
            let off = |at: &[f64; 2]| (at[0] - wanted[0]).hypot(at[1] - wanted[1]);
            off(a).total_cmp(&off(b))
        });
        let at = places.into_iter().find(|&at| {
            self.aim(at).is_some_and(|rig| {
                shows(&rig, size, wanted, down_m) && !around.iter().any(|&at| sees(&rig, at))
            })
        })?;
        Some(Fixation {
            point_m: [at[0], down_m, at[1]],
            why: Why::Without {
                shown: shown.clone(),
                hidden: hidden.clone(),
            },
        })
    }

    /// A fixation from which most is seen again that was not seen for long, by which a scan ends: what was moved
    /// where nobody looked is found, or given up. Nothing if the last look has placed everything.
    #[must_use]
    pub fn make_sure(&self) -> Option<Fixation> {
        let down_m = self.eyes_above_ground_m();
        let (object, at, height_m, looks) =
            self.attention
                .long_unseen(&self.memory, self.head.size, down_m, |at| self.aim(at))?;
        Some(Fixation {
            point_m: [at[0], down_m - height_m, at[1]],
            why: Why::LongUnseen { object, looks },
        })
    }

    /// A fixation on the first piece of the hand's way to an object that is not known to be free, which is
    /// where a question that the map cannot answer sends the eyes. Vergence brings the search to the
    /// ground there: from a fixation farther away the near edge of a table is out of its reach. Nothing if
    /// the map has an answer.
    #[must_use]
    pub fn on_the_way(&self, to: &ObjectId) -> Option<Fixation> {
        // The robot stands in the origin of the map.
        let FreePath::Unknown { at_m } = hand_way(&self.memory, to)? else {
            return None;
        };
        Some(Fixation {
            point_m: [at_m[0], self.eyes_above_ground_m(), at_m[1]],
            why: Why::OnTheWay { to: to.clone() },
        })
    }

    /// Whether the hand's straight way to where an object is believed is free in the room as it is.
    #[must_use]
    pub fn way_is_free(&self, to: &ObjectId) -> bool {
        let to = Observer::Object(to.clone());
        hand().is_some_and(|hand| is_free(&self.memory, &self.room, &self.head, &hand, &to))
    }

    /// The believed eyes that fixate a place on the ground.
    fn aim(&self, [right, forward]: [f64; 2]) -> Option<StereoRig> {
        let point = self.in_room([right, self.eyes_above_ground_m(), forward]);
        let read = self.head.fixate(point).ok()?.rig();
        self.params.errors.believed(read).ok()
    }

    /// A point of the observer frame in the room.
    fn in_room(&self, [right, down, forward]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.head.heading_rad.sin_cos();
        let [x, y, z] = self.head.position_m;
        [
            x + right * cos + forward * sin,
            y - right * sin + forward * cos,
            z - down,
        ]
    }

    /// Lets the head look there and the cameras take what they see. Half way through the scan one
    /// object is moved first.
    ///
    /// # Errors
    /// [`NoScan`] if the head cannot look there.
    pub fn show(&mut self, fixation: &Fixation) -> Result<Shown, NoScan> {
        let read = self.head.fixate(self.in_room(fixation.point_m))?.rig();
        let errors = &self.params.errors;
        let believed = errors.believed(read)?;
        let actual = errors.actual(read, self.lenses, &mut self.chance)?;
        let Head {
            position_m,
            heading_rad,
            size,
            ..
        } = self.head;
        let gaze = Gaze::new(position_m, heading_rad, size, actual)?;
        let number = self.looks as u32 + 1;
        let exposure = Exposure {
            noise_seed: (self.params.seed as u32).wrapping_mul(1009) ^ number,
            ..self.params.exposure
        };
        let view: View = render(&self.room, &gaze, exposure)?;
        Ok(Shown {
            fixation: fixation.clone(),
            pictures: view.colour.as_ref().map(eight_bits),
            view,
            believed,
        })
    }

    /// Moves the object whose turn it is, if it is time, and says which.
    pub fn stir(&mut self) -> Option<String> {
        if self.looks != self.params.fixations / 2 {
            return None;
        }
        let relocation = self.relocation.take()?;
        self.room = relocation.done(&self.room)?;
        Some(relocation.object)
    }

    /// Looks: from the two pictures to disparity, the right eye's place, depth, the objects' places,
    /// and the memory.
    ///
    /// # Errors
    /// [`NoScan`] if a level refuses. That the memory refuses is no error but part of the look.
    pub fn perceive(&mut self, shown: Shown, moved: Option<String>) -> Result<ScanLook, NoScan> {
        let errors = self.params.errors;
        let eyes = shown.pictures.as_ref().try_map(luma)?;
        let responses = eyes.as_ref().try_map(|eye| self.bank.respond(eye));
        let responses = responses.map_err(Error::from)?;
        // What is wrongly there does more harm to a map than what is missed, and is looked for again.
        // Patches may be small all the same, as things in small pictures are.
        let matching = MatchParams {
            least_patch: 0,
            left_right_px: Some(1.0),
            slanted_scales: 3,
            contradictions: None,
            fill_neighbours: Some(12),
            ..MatchParams::default()
        };
        let found = Range::Given.disparity(&responses, matching);
        let disparity = found.map_err(Error::from)?.field;

        let (rig, drift) = if errors == HeadErrors::none() {
            (shown.believed, None)
        } else {
            let params = OrientationParams::expecting(errors.expected(self.belief.as_ref())?);
            let found = relative_orientation(&disparity, &shown.believed, &params);
            let rig = match &found {
                Ok(found) => shown
                    .believed
                    .drifted(&found.drift)?
                    .with_sigma(found.standard_error)?,
                Err(_) => shown.believed,
            };
            (rig, Some(found))
        };
        let told = drift.as_ref().is_none_or(Result::is_ok);

        let depth = triangulate(&disparity, &rig);
        let names = names(&self.room);
        let (labels, cut) = whole(&shown.view.truth.labels);
        let cut = cut
            .into_iter()
            .map(|label| object_id(label, &names))
            .collect();
        let locating = LocateParams::default();
        let egocentric = locate(&depth, &labels, &rig, &locating)?;
        let qualitative = QualitativeScene::qualify_with(
            sightings(&egocentric, &names),
            &self.params.reference,
            self.params.memory.qualify,
        )?;

        self.looks += 1;
        let heading_sigma_rad = errors.encoder_sigma_rad;
        let pose = RobotPose::new(GroundPose::default(), [[0.0; 2]; 2], heading_sigma_rad)?;
        let down_m = self.eyes_above_ground_m();
        let marked = SeenThings::new(&shown.view.truth.labels, &names);
        let seen: Vec<(Observation, &LocatedObject)> =
            observations(&egocentric, &names, &rig, down_m)
                .zip(&egocentric.objects)
                .filter(|(seen, object)| {
                    let foot = marked.foot(&seen.sighting.object, &rig, down_m);
                    is_seen(seen, object, foot)
                })
                .collect();
        let things = marked.placed(&rig, seen.iter().map(|(_, object)| *object));
        let look = Look {
            time_ms: self.memory.time_ms() + PERIOD_MS,
            pose: PoseKnowledge::Known(pose),
            observations: seen
                .into_iter()
                .map(|(seen, object)| widened(seen, object, errors.encoder_sigma_rad))
                .collect(),
        };
        let close = if matches!(shown.fixation.why, Why::OnTheWay { .. }) && told {
            self.densely(&eyes, &shown.pictures, &rig)?
        } else {
            None
        };
        let ground = close.as_ref().unwrap_or(&depth);
        let evidence =
            DepthEvidence::new(ground, &rig, down_m, locating.disparity_sigma_px).beside(&things);
        let (changes, refused) = if told {
            match self.memory.observe(&look, &evidence) {
                Ok(changes) => (changes, None),
                Err(refused) => (Vec::new(), Some(refused.to_string())),
            }
        } else {
            let reason = "the images do not tell where the right eye is";
            (Vec::new(), Some(reason.to_owned()))
        };
        if refused.is_none() {
            let memory = &self.memory;
            let known = |at: [f64; 2]| measured(&evidence, memory, at);
            self.attention.looked(&rig, self.head.size, down_m, known);
            let placed: Vec<&ObjectId> = look
                .observations
                .iter()
                .map(|seen| &seen.sighting.object)
                .collect();
            let seen = things.objects().map(|object| SeenThing {
                object: object.clone(),
                placed: placed.contains(&object),
                foot: things
                    .foot(object, &rig, down_m)
                    .map(|foot| [foot.right_m, foot.forward_m])
                    .filter(|at| at[0].hypot(at[1]) < FARTHEST_M),
            });
            let seen: Vec<SeenThing> = seen.collect();
            self.attention.saw(&seen, shown.fixation.why.aimed_at());
        }
        if let Some(Ok(found)) = &drift {
            self.belief = Some(found.belief);
        }
        Ok(ScanLook {
            number: self.looks,
            shown,
            rig,
            drift,
            percept: Percept {
                disparity,
                starts: Vec::new(),
                depth,
                egocentric,
                qualitative,
            },
            cut,
            changes,
            refused,
            memory: self.memory.clone(),
            moved,
        })
    }

    /// The depth of a look by the dense estimator, along the rows of a pair rectified by what the look itself
    /// has found out of the right eye. It knows a table that lies close before the eyes, which slants too
    /// much for the vector pyramid; nothing if there is too little to see. Whether ground is free rests on
    /// it where that was asked; no object's place does, for it has no calibrated error.
    fn densely(
        &self,
        eyes: &Binocular<LumaImage>,
        pictures: &Binocular<Array2<[u8; 3]>>,
        rig: &StereoRig,
    ) -> Result<Option<DepthMap>, NoScan> {
        // Edges as sharp as the preset's leave ground on a table close before the eyes unknown that these know.
        let params = DenseParams {
            edge_softness: 0.02,
            ..DenseParams::fast()
        };
        let look = DenseLook {
            params,
            search: Search::default(),
            rows: Rows::Rectified,
        };
        let views = Binocular {
            left: EyeView {
                luma: &eyes.left,
                rgb: Some(pictures.left.view()),
            },
            right: EyeView {
                luma: &eyes.right,
                rgb: Some(pictures.right.view()),
            },
        };
        match look.disparity(&views, rig, &self.bank, MatchParams::default()) {
            Ok(field) => Ok(Some(triangulate(&field, rig))),
            Err(Error::NoSearch) => Ok(None),
            Err(refused) => Err(refused.into()),
        }
    }

    /// The map as it is beside the room as it is.
    ///
    /// # Errors
    /// [`NoScan`] if the truth cannot be rendered.
    pub fn score(&self) -> Result<Score, NoScan> {
        let truth = self.truth()?;
        Ok(Score::of(&self.memory, &truth, &self.room, &self.head)?)
    }

    /// Where everything truly is now.
    ///
    /// # Errors
    /// [`NoScan`] if the truth cannot be rendered.
    pub fn truth(&self) -> Result<TruePlaces, NoScan> {
        Ok(TruePlaces::of(&self.room, &self.head)?)
    }

    /// How numbers become symbols.
    #[must_use]
    pub const fn qualify(&self) -> QualifyParams {
        self.params.memory.qualify
    }
}

/// Whether an object is seen and not guessed: a third of its pixels agree on their depth, and these
/// spread by no more than the object is wide. What is too near for the search matches by chance, and
/// such matches lie all over the place: with an eighth, and a coherence of 0.7, 30 of 374 things in fifty
/// rooms were believed more than 10 cm from where they are. How many are missing counts in [`widened`].
///
/// Where the foot of its picture meets the ground is a second witness, which knows no matches: a
/// quarter of the pixels is enough if they put the object where it stands, and none are if they put it
/// farther off than its width and three standard errors.
fn is_seen(seen: &Observation, object: &LocatedObject, foot: Option<Foot>) -> bool {
    let (agreeing, radius_m) = (object.agreeing_pixels, f64::from(seen.radius_mm) / 1e3);
    let off = foot.filter(|foot| foot.is_whole).map(|foot| {
        let off_m = foot.right_m.hypot(foot.forward_m) - seen.sighting.distance_m;
        (off_m.abs(), 3.0 * foot.pixel_m)
    });
    let agrees = off.is_some_and(|(off_m, grain_m)| off_m < radius_m + grain_m);
    let refutes = off.is_some_and(|(off_m, grain_m)| {
        off_m > 2.0 * radius_m + 3.0 * seen.sighting.sigma_distance_m + grain_m
    });
    let part = if agrees { 4 } else { 3 };
    !refutes && part * agreeing >= object.pixels && object.spread_m <= 2.0 * radius_m
}

/// How far around a place the ground must be told of for the place to count as measured, in metres.
const GROUND_M: f64 = 0.025;

/// A foot seen farther away than this is no reason to look there, in metres.
const FARTHEST_M: f64 = 3.0;

/// Whether a look tells something of a place of the ground: that it is free, that something stands
/// before it, or that a known thing stands on it.
fn measured(
    evidence: &DepthEvidence<'_>,
    memory: &SceneMemory,
    [right, forward]: [f64; 2],
) -> bool {
    let params = memory.params();
    let place = AskedPlace {
        right_m: right,
        forward_m: forward,
        height_m: f64::from(params.above_ground_mm) / 1e3,
        within_m: GROUND_M,
        radius_m: 0.0,
    };
    let told = matches!(evidence.at(place), Evidence::FreeSpace | Evidence::Occluded);
    told || memory.objects().any(|(name, kept)| {
        let reach_m = f64::from(kept.radius_mm) / 1e3 + place.within_m;
        memory
            .from_robot(name)
            .is_some_and(|at| (at.right_m - right).hypot(at.forward_m - forward) < reach_m)
    })
}

/// A sighting with the errors that depth does not know of.
///
/// The tilt is read with an error, which moves what lies below the eyes along the line of sight. And
/// where part of an object has no depth, or one that does not agree, its middle may lie aside of the
/// middle of the rest: by half of that part of its radius, and by as much of its depths' spread.
fn widened(mut seen: Observation, object: &LocatedObject, encoder_sigma_rad: f64) -> Observation {
    let unseen = 1.0 - object.agreeing_pixels as f64 / object.pixels.max(1) as f64;
    let aside_m = 0.5 * unseen * f64::from(seen.radius_mm) / 1e3 + MIDDLE * object.spread_m;
    let along_m = MIDDLE * object.spread_m + 0.5 * unseen * object.spread_m;
    let tilt_m = encoder_sigma_rad * object.position.y_m;
    let sighting = &mut seen.sighting;
    sighting.sigma_distance_m = sighting.sigma_distance_m.hypot(tilt_m).hypot(along_m);
    sighting.sigma_bearing_rad = sighting
        .sigma_bearing_rad
        .hypot(aside_m / sighting.distance_m);
    seen
}

/// The middle of an object's pixels at the middle of its depths is no point of its surface where that
/// bends: it lies off the surface's middle by some part of the depths' spread.
const MIDDLE: f64 = 0.3;

/// The labels without those that the edge of the image cuts, and these.
fn whole(labels: &LabelImage) -> (LabelImage, Vec<Label>) {
    let plane = labels.plane();
    let (height, width) = plane.dim();
    let present = labels.labels();
    let cut: Vec<_> = present
        .into_iter()
        .filter(|label| {
            let number = label.0.get();
            let edge = |y: usize, x: usize| plane[[y, x]] == number;
            (0..width).any(|x| edge(0, x) || edge(height - 1, x))
                || (0..height).any(|y| edge(y, 0) || edge(y, width - 1))
        })
        .collect();
    let kept = plane.mapv(|number| {
        if cut.iter().any(|label| label.0.get() == number) {
            0
        } else {
            number
        }
    });
    (LabelImage::new(kept), cut)
}

/// A rendered colour image `[[y, x, channel]]` as a camera of eight bits delivers it.
fn eight_bits(colour: &Array3<f32>) -> Array2<[u8; 3]> {
    // The cast saturates, so that a sample beyond white stays white.
    colour.map_axis(Axis(2), |rgb| {
        [rgb[0], rgb[1], rgb[2]].map(|sample| (sample * 255.0).round() as u8)
    })
}

/// Grey of a picture, with the weights of ITU-R Rec. 601.
fn luma(picture: &Array2<[u8; 3]>) -> Result<LumaImage, NotAnImage> {
    LumaImage::new(picture.mapv(|rgb| {
        let [red, green, blue] = rgb.map(|code| f32::from(code) / 255.0);
        0.299 * red + 0.587 * green + 0.114 * blue
    }))
}
