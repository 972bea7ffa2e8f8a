use std::collections::BTreeMap;

use dorsal::Names;
use dorsal::allocentric_qsr::{
    BadSighting, DepthReference, ObjectId, QualifyParams, QualitativeScene, Sighting,
};
use dorsal::egocentric_depth::{Label, Observer, Position};
use dorsal::v1_gabor::Size;
use stereo_scenes::{Exposure, Head, NoView, Room, render};

/// Where every object of a room is for a perfect observer at the head's place: the middle of the part
/// of its surface that both eyes see when they fixate it.
#[derive(Clone, Debug, Default)]
pub struct TruePlaces(BTreeMap<ObjectId, TruePlace>);

/// Where one object truly is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruePlace {
    /// The middle of its seen surface, in the observer frame.
    pub position: Position<Observer>,
    /// How many pixels of a picture of 256 x 192 show it.
    pub pixels: usize,
}

/// Truth needs no fine picture: a pixel is some 4 mm at 1 m, its median over an object far less.
const TRUTH: Size = Size {
    width: 256,
    height: 192,
};

impl TruePlaces {
    /// The places of all objects that the head can see.
    ///
    /// # Errors
    /// [`NoView`] if the head stands outside of the room.
    pub fn of(room: &Room, head: &Head) -> Result<Self, NoView> {
        let mut places = BTreeMap::new();
        for (label, name) in room.names() {
            if let Some(place) = TruePlace::of(room, head, label)? {
                places.insert(ObjectId::new(name), place);
            }
        }
        Ok(Self(places))
    }

    /// The place of an object; nothing if the head cannot see it.
    #[must_use]
    pub fn get(&self, object: &ObjectId) -> Option<TruePlace> {
        self.0.get(object).copied()
    }

    /// Every object that the head can see, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&ObjectId, TruePlace)> {
        self.0.iter().map(|(name, place)| (name, *place))
    }

    /// The true places in symbols, without any error.
    ///
    /// # Errors
    /// None for places in front of a head; [`BadSighting`] names what cannot be.
    pub fn scene(
        &self,
        reference: &DepthReference,
        params: QualifyParams,
    ) -> Result<QualitativeScene, BadSighting> {
        let sightings = self.0.iter().map(|(name, place)| Sighting {
            object: name.clone(),
            distance_m: place.position.distance_m(),
            bearing_rad: place.position.bearing_rad(),
            sigma_distance_m: 0.0,
            sigma_bearing_rad: 0.0,
        });
        QualitativeScene::qualify_with(sightings, reference, params)
    }
}

impl TruePlace {
    /// The place of one object, `None` if the head cannot see it.
    pub(crate) fn of(room: &Room, head: &Head, label: Label) -> Result<Option<Self>, NoView> {
        let at = usize::from(label.0.get()) - 1;
        let Some(thing) = room.objects().get(at) else {
            return Ok(None);
        };
        let Ok(gaze) = head.resized(TRUTH).fixate(thing.shape.centre_m()) else {
            return Ok(None);
        };
        let exposure = Exposure {
            samples: 1,
            ..Exposure::default()
        };
        let view = render(room, &gaze, exposure)?;
        let seen = &view.truth.objects[at];
        Ok(seen.surface.map(|surface| Self {
            position: Position::from_array(surface.point_m),
            pixels: seen.binocular_pixels,
        }))
    }
}

/// The names of a room's objects as the levels take them.
pub(crate) fn names(room: &Room) -> Names {
    let names = room.names();
    names
        .map(|(label, name)| (label, name.to_owned()))
        .collect()
}
