# space-robot on Debian with its Python: docker build -t space-robot . && docker run --rm -it space-robot list
FROM debian:bookworm-slim
RUN apt-get update && apt-get install -y --no-install-recommends python3 python3-venv libgomp1 && rm -rf /var/lib/apt/lists/*
# ROS writes its own logs below HOME, and `docker run --user` brings an account that has none.
ENV PATH=/opt/space-robot/bin:$PATH AMENT_PREFIX_PATH=/opt/space-robot HOME=/work NUMBA_CACHE_DIR=/var/cache/space-robot
COPY . /src
RUN python3 -m venv /opt/space-robot \
 && pip install --no-cache-dir '/src[ros,viz,view,robots,campaign,mpc,pandas]' \
 && rm -rf /src \
 && mkdir -p /work "$NUMBA_CACHE_DIR" \
 # Plant and laws are compiled here, not in the first run of everyone.
 && cd /tmp && space-robot run liu2023/fig08 --out /tmp/fig08 && rm -rf /tmp/fig08 \
 && chmod -R a+rwX /work "$NUMBA_CACHE_DIR"
WORKDIR /work
ENTRYPOINT ["space-robot"]
CMD ["--help"]
