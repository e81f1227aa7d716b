# The four commands, without a window:
#
#     docker build -t plant-growth-clips .
#     docker run --rm -v "$PWD:/work" -u "$(id -u)" plant-growth-clips bake scans -o plant.gclip
FROM python:3.11-slim

# OpenGL on the processor, for pictures and films; what Open3D needs besides.
RUN apt-get update \
    && apt-get install -y --no-install-recommends libegl1 libgl1 libgomp1 libusb-1.0-0 libx11-6 \
    && rm -rf /var/lib/apt/lists/*

COPY . /source
RUN pip install --no-cache-dir "/source[e57,pandas,usd]" && rm -r /source

# The solver is compiled once, here; whoever runs the commands may keep what is compiled later.
ENV NUMBA_CACHE_DIR=/var/cache/numba HOME=/tmp
RUN python -m baker.transport.compile && chmod -R a+rwX /var/cache/numba

WORKDIR /work
CMD ["bake", "--help"]
