const kLatestMs = 3000; // a decoder that answers no more has failed

const kVp8 = {
  codec: 'vp8',
  optimizeForLatency: true, // each frame out as soon as it is in
  hardwareAcceleration: 'prefer-software', // shorter ways than to a graphics card and back
  // What the server encodes; a browser would guess by size, and shift the colours of large pictures.
  colorSpace: { matrix: 'smpte170m', primaries: 'bt709', transfer: 'iec61966-2-1', fullRange: false },
};

/** Whether this browser decodes VP8 here: WebCodecs is there in secure contexts only. */
export async function canDecodeVp8(scope = window) {
  if (!scope.isSecureContext || !scope.VideoDecoder) return false;
  try {
    return (await scope.VideoDecoder.isConfigSupported(kVp8)).supported === true;
  } catch {
    return false;
  }
}

/** Makes pictures of frames, one after the other: JPEG, PNG (whole or in parts) and a VP8 stream. */
export class FrameDecoder {
  #video = null;
  #waiting = null; // {resolve, reject} of the frame in the video decoder
  #parts = null; // {frame, bytes, filled}: a lossless image that has not come whole

  /** Resolves to something to draw and to close(), or to null for a part that is not the last. */
  async decode({ header, payload }) {
    const whole = this.#gather(header, payload);
    if (whole === null) return null;
    if (header.codec === 'vp8') return this.#decodeVideo(header, whole);
    return createImageBitmap(new Blob([whole], { type: `image/${header.codec}` }));
  }

  /** Starts anew: the next frame of a stream must be a key frame. */
  reset() {
    this.#end(new Error('the connection was lost'));
    this.#parts = null;
  }

  #gather({ frame, part }, payload) {
    if (part === null) {
      this.#parts = null;
      return payload;
    }
    if (this.#parts?.frame !== frame || part.offset === 0) {
      this.#parts = { frame, bytes: new Uint8Array(part.size), filled: 0 };
    }
    const parts = this.#parts;
    if (parts.filled !== part.offset) throw new Error('a part of a frame is missing');
    parts.bytes.set(payload, part.offset);
    parts.filled += payload.length;
    if (parts.filled < part.size) return null;
    this.#parts = null;
    return parts.bytes;
  }

  #decodeVideo(header, bytes) {
    if (header.key) this.#start(header);
    if (this.#video?.state !== 'configured') throw new Error('a stream began without a key frame');
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => this.#end(new Error('VP8 took too long')), kLatestMs);
      const settle = (how) => (value) => {
        clearTimeout(timer);
        this.#waiting = null;
        how(value);
      };
      this.#waiting = { resolve: settle(resolve), reject: settle(reject) };
      this.#video.decode(new EncodedVideoChunk({
        type: header.key ? 'key' : 'delta', timestamp: header.frame * 1000, data: bytes }));
    });
  }

  #start({ width, height }) {
    if (this.#video === null || this.#video.state === 'closed') {
      this.#video = new VideoDecoder({
        output: (picture) => {
          if (this.#waiting) this.#waiting.resolve(picture);
          else picture.close();
        },
        error: (failure) => this.#end(failure),
      });
    }
    this.#video.configure({ ...kVp8, codedWidth: width, codedHeight: height });
  }

  #end(failure) {
    if (this.#video && this.#video.state !== 'closed') this.#video.close();
    this.#video = null;
    this.#waiting?.reject(failure);
  }
}
