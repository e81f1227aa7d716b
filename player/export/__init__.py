"""Pictures, films, pages, geometry and tables of a clip, drawn without a screen."""

import lazy_loader

# numpy and the formats load when something is exported: `play --help` stays instant.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
