//! EXR: many named channels of numbers in one file.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec, Text, WritableImage,
};

/// An EXR file of channels by name, each with a 32-bit number a pixel in reading order; compressed without loss. `comments` is the
/// attribute of this name.
///
/// # Errors
///
/// What the encoder says, as of names that no channel can have.
pub(crate) fn encode_exr(
    width: u32,
    height: u32,
    channels: Vec<(String, Vec<f32>)>,
    comments: Option<&str>,
) -> Result<Vec<u8>, String> {
    let channel = |(name, values): (String, Vec<f32>)| AnyChannel::new(name.as_str(), FlatSamples::F32(values));
    let channels = AnyChannels::sort(SmallVec::from_vec(channels.into_iter().map(channel).collect()));
    let size = (width as usize, height as usize);
    let attributes = LayerAttributes { comments: comments.map(Text::from), ..LayerAttributes::default() };
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut file = Cursor::new(Vec::new());
    let written = Image::from_layer(layer).write().non_parallel().to_buffered(&mut file);
    written.map_err(|error| error.to_string())?;
    Ok(file.into_inner())
}
