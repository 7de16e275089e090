import { Connection } from './connection.js';
import { Controls } from './controls.js';
import { Edits } from './edits.js';
import { Measurements } from './measurements.js';
import { Toasts } from './toasts.js';
import { Trackball } from './trackball.js';
import { Viewer } from './viewer.js';

const element = (id) => document.getElementById(id);

/** ws://HOST/sessions/NAME/stream?scene=NAME, from this page's own ?session=…&scene=…. */
function streamUrl(location) {
  const parameters = new URLSearchParams(location.search);
  const session = encodeURIComponent(parameters.get('session') || 'default');
  const scene = parameters.get('scene');
  const protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
  const query = scene ? `?scene=${encodeURIComponent(scene)}` : '';
  return `${protocol}//${location.host}/sessions/${session}/stream${query}`;
}

const connection = new Connection(streamUrl(window.location));
const edits = new Edits((message) => connection.send(message));
const viewer = new Viewer(element('canvas'), element('stage'));
const measurements = new Measurements(document);
const toasts = new Toasts(element('toasts'));
const controls = new Controls(change);
const trackball = new Trackball(element('canvas'), {
  onTurn: (rotation) => edits.set({ rotation }),
  onGrab: (grabbed) => {
    element('canvas').classList.toggle('dragging', grabbed);
    if (!grabbed) adopt();
  },
});

let newest = null; // {epoch, revision, state}: what the server said last

function change(part) {
  if (part.rotation) trackball.setRotation(part.rotation);
  edits.set(part);
}

/** Shows the session's state as the server has it, but never against the user's own hand. */
function adopt() {
  if (newest === null || trackball.isDragging || edits.isBusy) return;
  trackball.setRotation(newest.state.rotation);
  controls.show(newest.state);
}

function isNewer(message) {
  return newest === null || message.epoch > newest.epoch ||
    (message.epoch === newest.epoch && message.revision > newest.revision);
}

const handlers = {
  welcome(message) {
    newest = message;
    edits.restart();
    viewer.setSize(message.size);
    trackball.setCamera(message.camera);
    controls.setEnvironments(message.environments);
    element('scene').textContent = message.scene;
    element('session').textContent = message.session === 'default' ? '' : message.session;
    document.title = `${message.scene} – Rimlight`;
    adopt();
  },
  ack(message) {
    edits.acknowledged(message.id, message.revision);
    handlers.state(message);
  },
  state(message) {
    if (isNewer(message)) newest = message;
    adopt();
  },
  error(message) {
    if (message.id) edits.refused(message.id);
    toasts.say(message.reason);
  },
};

connection.addEventListener('message', ({ detail }) => handlers[detail.type]?.(detail));

connection.addEventListener('frame', async ({ detail }) => {
  try {
    await viewer.draw(detail);
  } catch (failure) {
    toasts.say(`A frame could not be shown: ${failure.message}`);
  }
  const now = performance.now();
  connection.send({ type: 'frame_ack', frame: detail.header.frame });
  measurements.show(detail.header, detail.bytes,
    edits.latencyOf(detail.header.revision, now), now);
  element('canvas').dataset.frame = detail.header.frame;
  element('canvas').dataset.exact = detail.header.exact;
});

connection.addEventListener('status', ({ detail }) => {
  const words = {
    open: 'Connected',
    connecting: detail.again ? 'Reconnecting…' : 'Connecting…',
    waiting: `Connection lost. Reconnecting in ${Math.max(1, Math.round(detail.seconds))} s…`,
  };
  const status = element('connection');
  status.textContent = words[detail.state];
  status.dataset.state = detail.state;
  element('picture').classList.toggle('stale', detail.state !== 'open');
});

connection.open();
