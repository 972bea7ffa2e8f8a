use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::allocentric_map::{AllocentricMap, Remembered};
use crate::depth_reference::DepthReference;
use crate::ground_pose::GroundPose;
use crate::place::owned_labels;
use crate::premise::{Premise, Premises};
use crate::qualitative_scene::QualifyParams;
use crate::sighting::BadSighting;
use crate::{DepthSet, Inference, Mode, ObjectId, OrientationSet};

/// The form of a map as data. A change of form changes the number.
const SCHEMA: &str = "dorsal-map/1";

/// Why data are no map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadMap {
    /// The data have another schema.
    #[error("schema `{0}` is unknown; this library reads `dorsal-map/1`")]
    Schema(String),
    /// The parameters cannot be.
    #[error(transparent)]
    Params(#[from] BadSighting),
    /// An object is seen in a look that the map has not had, or has a negative variance.
    #[error("`{0}` is remembered in a way no look can show it")]
    Object(ObjectId),
    /// A pair of objects is out of order, unknown, or told by labels the system does not have.
    #[error("the relation of `{0}` and `{1}` is none of this map")]
    Pair(ObjectId, ObjectId),
}

/// A map as data.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MapRecord {
    schema: String,
    reference: DepthReference,
    params: QualifyParams,
    looks: u64,
    pose: GroundPose,
    objects: BTreeMap<ObjectId, Remembered>,
    /// What the looks said of pairs; what follows from it is worked out again.
    published: Vec<PremiseRecord>,
}

/// A premise as data, in labels.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PremiseRecord {
    first: ObjectId,
    second: ObjectId,
    depth: Vec<String>,
    second_at_first: OrientationSet,
    first_at_second: OrientationSet,
    look: u64,
}

impl MapRecord {
    pub(crate) fn of(map: &AllocentricMap) -> Self {
        let published = map.premises.iter().map(|((first, second), premise)| {
            let depth = owned_labels(&map.reference, premise.depth);
            PremiseRecord {
                first: first.clone(),
                second: second.clone(),
                depth,
                second_at_first: premise.second_at_first,
                first_at_second: premise.first_at_second,
                look: premise.look,
            }
        });
        Self {
            schema: SCHEMA.to_owned(),
            reference: map.reference.clone(),
            params: map.params,
            looks: map.looks,
            pose: map.pose,
            objects: map.remembered.clone(),
            published: published.collect(),
        }
    }

    pub(crate) fn into_map(self) -> Result<AllocentricMap, BadMap> {
        if self.schema != SCHEMA {
            return Err(BadMap::Schema(self.schema));
        }
        self.params.check()?;
        let happened = |look: u64| (1..=self.looks).contains(&look);
        for (object, kept) in &self.objects {
            if !(happened(kept.last_seen) && kept.estimate.is_sane()) {
                return Err(BadMap::Object(object.clone()));
            }
        }
        let mut premises = Premises::new();
        for record in self.published {
            let pair = (record.first, record.second);
            let named = record.depth.iter().map(|l| self.reference.class_named(l));
            let depth: Option<DepthSet> = named.collect();
            let known = [&pair.0, &pair.1].map(|object| self.objects.contains_key(object));
            let ordered = pair.0 < pair.1 && !premises.contains_key(&pair);
            match depth {
                Some(depth)
                    if !depth.is_empty()
                        && known == [true; 2]
                        && ordered
                        && happened(record.look) =>
                {
                    let premise = Premise {
                        depth,
                        second_at_first: record.second_at_first,
                        first_at_second: record.first_at_second,
                        look: record.look,
                    };
                    premises.insert(pair, premise);
                }
                _ => return Err(BadMap::Pair(pair.0, pair.1)),
            }
        }
        Ok(AllocentricMap {
            inference: Inference::close(&self.reference, Mode::Published, &premises),
            reference: self.reference,
            params: self.params,
            looks: self.looks,
            pose: self.pose,
            remembered: self.objects,
            premises,
        })
    }
}
