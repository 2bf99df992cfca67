//! What one eye leaves to the next that looks at the same spheres.

use std::any::Any;
use std::sync::{Arc, Mutex, OnceLock};

use crate::accel::KeptLists;
use crate::census::Census;
use crate::geometry::{shape_indices_among, twins};
use crate::scene::{Scene, Sphere};
use crate::threads::lock;

/// Of one scene, for all eyes that look at its spheres; its lights may move.
#[derive(Debug, Default)]
pub struct Kept {
    /// The lists around the lights, and the grid.
    pub(crate) lists: KeptLists,
    /// In the units of kernels that are so many times those of the file.
    census: Mutex<Option<(f64, Arc<Census>)>>,
    /// Spheres that some move can make the same, as long as none of their coordinates is greater.
    twins: Mutex<Option<(f64, Arc<[u32]>)>>,
    /// The scene as an eye has had it that no one has any more: all but the places of its spheres is as ever.
    moved: Mutex<Option<Scene>>,
    /// What a device has; no one else knows what that is.
    tables: OnceLock<Arc<dyn Any + Send + Sync>>,
}

impl Kept {
    /// The census of `scene`, in units that are `factor` times those of the file.
    pub(crate) fn census(&self, scene: &Scene, factor: f64) -> Arc<Census> {
        let mut kept = lock(&self.census);
        match &*kept {
            Some((of, census)) if *of == factor && census.serves(scene) => Arc::clone(census),
            _ => Arc::clone(&kept.insert((factor, Arc::new(Census::of(scene)))).1),
        }
    }

    /// As [`crate::geometry::shape_indices`] of `moved`, which is `file` after a move; no coordinate of either is greater than `reach`.
    pub(crate) fn shape_indices(&self, [moved, file]: [&[Sphere]; 2], reach: f64, true_axes: bool) -> Option<Vec<u32>> {
        let mut kept = lock(&self.twins);
        let (_, among) = match &mut *kept {
            Some(kept) if reach <= kept.0 => kept,
            // With room for eyes that are farther away.
            kept => kept.insert((2.0 * reach, twins(file, 2.0 * reach))),
        };
        shape_indices_among(moved, true_axes, among)
    }

    /// What a device keeps, of the one kind that there is.
    pub(crate) fn tables<T: Any + Send + Sync + Default>(&self) -> Option<Arc<T>> {
        Arc::clone(self.tables.get_or_init(|| Arc::new(T::default()))).downcast().ok()
    }

    /// A scene whose spheres are those of the file but for their places.
    pub(crate) fn take_moved(&self) -> Option<Scene> {
        lock(&self.moved).take()
    }

    /// Such a scene, whose memory the next eye may have.
    pub(crate) fn leave_moved(&self, scene: Scene) {
        *lock(&self.moved) = Some(scene);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::shape_indices;
    use crate::settings::Settings;
    use crate::view::View;

    #[test]
    fn a_census_is_of_its_units() {
        let mut scene = Scene::new(crate::scene::Window::default(), 8, 8);
        scene.spheres.push(Sphere::new(DVec3::Z, 4.0, DVec3::ONE));
        let kept = Kept::default();
        assert_eq!(kept.census(&scene, 1.0).least.value, 4.0);
        scene.spheres[0].scale *= 0.5;
        assert_eq!(kept.census(&scene, 1.0).least.value, 4.0, "it is kept");
        assert_eq!(kept.census(&scene, 0.5).least.value, 2.0);
    }

    /// Pairs of spheres that are the same surface, or become it where an eye so far away rounds their places.
    #[test]
    fn surfaces_are_shared_for_each_eye_as_without_what_is_kept() {
        let mut scene = Scene::new(crate::scene::Window::default(), 8, 8);
        for index in 0..40 {
            let center = DVec3::new(0.1 * f64::from(index), 0.7, -5.0 - f64::from(index % 7));
            let apart = f64::EPSILON * f64::from(1_u32 << (index % 10)) * f64::from(index % 3);
            scene.spheres.extend([center, center + apart].map(|center| Sphere::new(center, 0.5, DVec3::ONE)));
        }
        let kept = Kept::default();
        let mut shared = Vec::new();
        for eye in [0.0, 0.1, 3.0, 1e3, -1e5, 0.3] {
            let view = View::new(DVec3::new(eye, 2.0 * eye, eye), None, DVec3::Y).expect("a view");
            let viewed = scene.viewed_again(&Settings { view, ..Settings::default() }, &kept);
            let indices = viewed.shape_indices(true);
            assert_eq!(indices, shape_indices(&viewed.scene().spheres, true), "eye {eye}");
            shared.push((0_u32..).zip(indices.unwrap_or_default()).filter(|(index, lowest)| index != lowest).count());
        }
        assert!(shared[0] >= 14 && shared[4] > shared[0] && shared[5] < shared[4], "{shared:?}");
    }
}
