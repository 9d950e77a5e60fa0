# The image of a host: docs/docker.md. Both of Docker's builders take this file: the classic one, which
# docker-compose 1.29 uses, knows no cache mounts and no heredocs; and no `# syntax=` line, which would ask a registry.

# glibc and not Alpine: Zenoh comes as no wheel for musl.
ARG BASE_IMAGE=python:3.11-slim-bookworm
# Has make and gcc; only the simulated robot needs it.
ARG TOOLS_IMAGE=python:3.11-bookworm
# A 32-bit machine compiles msgspec, for which there is no wheel: BUILD_IMAGE=python:3.11-bookworm has the compiler.
ARG BUILD_IMAGE=${BASE_IMAGE}


FROM ${BUILD_IMAGE} AS build
# What for: robot, recorder, web (it can speak to browsers), localization (it has numpy), camera (it has OpenCV), ros2
# (it can speak to ROS), laptop (with the command line, too) or sim (with the simulated robot). requirements/<that>.lock
# pins it.
ARG EXTRAS=robot
RUN python -m venv /opt/giraff
# The dependencies before the sources: a change of the sources does not install them again.
COPY requirements/${EXTRAS}.lock /tmp/requirements.lock
RUN /opt/giraff/bin/pip install --no-cache-dir --disable-pip-version-check --quiet --require-hashes \
    --requirement /tmp/requirements.lock
WORKDIR /opt/giraff/src
COPY pyproject.toml README.md LICENSE ./
COPY schemas schemas
COPY services services
# Editable, so that the simulator finds its boards, and a healthcheck its program, at a path without Python's version.
# The container's user is not the one who cloned, whose umask may have kept the files to himself; and it may not write
# what Python compiles. pip has done its work, and is the largest part of what is left.
RUN /opt/giraff/bin/pip install --no-cache-dir --disable-pip-version-check --quiet --no-deps --no-build-isolation \
    --editable . \
 && chmod -R a+rX . \
 && python -m compileall -q schemas services \
 && /opt/giraff/bin/pip uninstall --quiet --yes setuptools pip


FROM ${BASE_IMAGE} AS run
# 1000 is who the first user of most machines is: a bundle of keys copied there by him can be read.
# Volumes get the owner of these folders, in whichever image they are first used.
RUN useradd --uid 1000 --groups dialout --no-create-home --home-dir /tmp giraff \
 && install -d -o giraff -g giraff /var/lib/giraff /run/giraff-board \
 && install -d -o giraff -g giraff -m 2770 /run/giraff/network
COPY --from=build /opt/giraff /opt/giraff
# A log line is seen when it is written. Nothing is compiled at a start: the file system is read-only.
ENV PATH=/opt/giraff/bin:$PATH PYTHONUNBUFFERED=1 PYTHONDONTWRITEBYTECODE=1
USER giraff
WORKDIR /tmp

# A stage for each, which docker-compose asks for by the same word.
FROM run AS robot
FROM run AS recorder
FROM run AS web
FROM run AS localization
FROM run AS camera
FROM run AS ros2
FROM run AS laptop


# The boards' C for this machine, and the boards that are a process on it. Last, because the classic builder makes every
# stage up to the one it is asked for.
FROM ${TOOLS_IMAGE} AS boards
COPY firmware /src/firmware
COPY deploy /src/deploy
RUN make -C /src/firmware host processes && chmod -R a+rX /src

# A base board that is a process in front of a motor controller.
FROM run AS process
COPY --from=boards /src/build/firmware /opt/giraff/boards

# The simulator looks for them where they are in the repository.
FROM run AS sim
COPY --from=boards /src/build/host/*.so /opt/giraff/src/build/host/
COPY --from=boards /src/build/firmware /opt/giraff/src/build/firmware
COPY --from=boards /src/firmware/host/board_model.h /opt/giraff/src/firmware/host/
COPY --from=boards /src/deploy /opt/giraff/src/deploy
