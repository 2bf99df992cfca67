//! Pictures of every k-th column and row, and of a size that a page can show.

use crate::effects::Effects;
use crate::engine::{Backend, Engine, Options, Output};
use crate::gpu;
use crate::kept::Kept;
use crate::scene::{Fov, Scene, Window};
use crate::settings::Settings;

/// Pixels of a page's picture on each side at the most: browsers show no larger ones everywhere.
const GREATEST_SIDE: u32 = 8192;

/// A renderer whose pixels are every `step`-th column and row of the picture of `size`, with the size that it renders.
pub(super) fn coarse_engine<'g, O: Output>(
    backend: Backend<'g>,
    (scene, kept): Shown,
    (settings, effects): (&Settings, &Effects),
    (size, fov): Framing,
    step: u32,
    options: &Options,
) -> Result<(Engine<'g, O>, (u32, u32)), gpu::Error> {
    framed(scene, (size, fov), |scene| {
        let (width, height) = (size.0.div_ceil(step), size.1.div_ceil(step));
        // The window reaches as far as its pixels, which may be beyond the picture. Its own size may be beyond numbers.
        let end = |from: f64, to: f64, count: u32, whole: u32| {
            let part = f64::from(count * step) / f64::from(whole);
            (from * (1.0 - part) + to * part).clamp(f64::MIN, f64::MAX)
        };
        if step > 1 {
            let window = scene.window;
            scene.window.right = end(window.left, window.right, width, size.0);
            scene.window.bottom = end(window.top, window.bottom, height, size.1);
        }
        (scene.width, scene.height) = (width, height);
        Ok((Engine::with(backend, scene.viewed_by(settings, kept), effects, options)?, (width, height)))
    })
}

/// A scene, and what its other pictures have left for the next eye, if there are any.
pub(super) type Shown<'s> = (&'s mut Scene, Option<&'s Kept>);

/// The size of a picture, and the field of view where it takes the place of the scene's window.
pub(super) type Framing = ((u32, u32), Option<Fov>);

/// Lets `action` see the scene so framed, and change its size and window; however it ends, the scene has its own again. A scene may be
/// too large to be copied for that.
pub(super) fn framed<T>(scene: &mut Scene, (size, fov): Framing, action: impl FnOnce(&mut Scene) -> T) -> T {
    struct Lent<'s>(&'s mut Scene, (u32, u32), Window);
    impl Drop for Lent<'_> {
        fn drop(&mut self) {
            (self.0.width, self.0.height) = self.1;
            self.0.window = self.2;
        }
    }
    let (own, window) = ((scene.width, scene.height), scene.window);
    let lent = Lent(scene, own, window);
    (lent.0.width, lent.0.height) = size;
    // Where there is no such window, nothing is rendered, and the page is told why: `start_job`.
    _ = fov.map(|fov| lent.0.set_fov(fov));
    action(lent.0)
}

/// `size`, halved until a page can show and keep it.
pub(super) fn fitted(size: (u32, u32), pixels: u64) -> (u32, u32) {
    let (mut width, mut height) = (size.0.max(1), size.1.max(1));
    while width.max(height) > GREATEST_SIDE || u64::from(width) * u64::from(height) > pixels {
        if width.max(height) == 1 {
            break;
        }
        (width, height) = (width.div_ceil(2), height.div_ceil(2));
    }
    (width, height)
}
