"""What is raised, with the messages of the command line. Arguments that make no sense are a ValueError instead."""


class Error(Exception):
    """Why there is no scene, no picture or no comparison."""


class SceneError(Error):
    """A scene cannot be read, has errors, or has numbers of which there is no picture."""


class DeviceError(Error):
    """There is no such device, it cannot do what is asked, or it has failed."""


class PictureError(Error):
    """A picture cannot be read, or has another size than the one beside it."""
